#include "scene/traced_surroundings.h"

#include "base/circle.h"
#include "shading/lobe_frame.h"

#include <algorithm>
#include <array>
#include <bit>

namespace rayleaf {
namespace {

/// Width to which a probe's ray opens, radians: surfaces may be diced as coarsely as for diffuse light.
constexpr float kProbeSpread = 0.1f;
/// Surfaces that one ray of a rounded normal may meet.
constexpr int kMostMeetings = 4;

/// A place on a disk by a density that falls as the cube of what is left to the rim (King et al., BSSRDF importance
/// sampling, 2013, after which Blender's Bevel node samples: for its pictures to be the same).
class CubicDisk {
  public:
    explicit CubicDisk(float radius) : radius_(radius) {}

    /// Where as large a share as `random` of the density lies within: r² (10 - 20 r + 15 r² - 4 r³) by bisection and
    /// Newton's steps, for a radius of 1.
    float sample(float random) const {
        constexpr int kSteps = 12;
        constexpr float kClose = 1e-6f;
        float low = 0.0f, high = 1.0f, r = 0.3f;
        for (int i = 0; i < kSteps; ++i) {
            const float share = r * r * (10.0f + r * (-20.0f + r * (15.0f - 4.0f * r)));
            (share > random ? high : low) = r;
            const float left = 1.0f - r, slope = 20.0f * r * left * left * left;
            const float newton = slope > 0.0f ? r - (share - random) / slope : low, before = r;
            r = newton > low && newton < high ? newton : 0.5f * (low + high);
            if (std::abs(r - before) < kClose) break;
        }
        return r * radius_;
    }
    /// Per area.
    float density(float distance) const {
        const float left = 1.0f - distance / radius_;
        return left > 0.0f ? 10.0f * left * left * left / (kPi * radius_ * radius_) : 0.0f;
    }

  private:
    float radius_;
};

/// The axis that a ray runs along, the two across it, and how likely each of them is chosen.
struct ProbeAxes {
    std::array<Vec3f, 3> axes;
    std::array<float, 3> chances;
};

/// Along the normal half of the time, else along one of the two tangents; `random` is stretched to be used again.
ProbeAxes choose_axes(const Vec3f& normal, float& random) {
    Vec3f tangent, bitangent;
    orthonormal_basis(normal, tangent, bitangent);
    if (random < 0.5f) {
        random *= 2.0f;
        return {{normal, tangent, bitangent}, {0.5f, 0.25f, 0.25f}};
    }
    if (random < 0.75f) {
        random = (random - 0.5f) * 4.0f;
        return {{tangent, bitangent, normal}, {0.25f, 0.25f, 0.5f}};
    }
    random = (random - 0.75f) * 4.0f;
    return {{bitangent, normal, tangent}, {0.25f, 0.5f, 0.25f}};
}

/// Multiple importance sampling of the three axes: the power heuristic, over the density of the one that was chosen.
float axis_weight(const ProbeAxes& chosen, const Vec3f& facet_normal) {
    float sum = 0.0f;
    std::array<float, 3> densities;
    for (size_t i = 0; i < 3; ++i) {
        densities[i] = chosen.chances[i] * std::abs(chosen.axes[i].dot(facet_normal));
        sum += densities[i] * densities[i];
    }
    return sum > 0.0f ? densities[0] / sum : 0.0f;
}

int hidden_locally(const Tracer& tracer, uint32_t instance, std::span<const RayQuery> rays) {
    return static_cast<int>(std::count_if(rays.begin(), rays.end(), [&](const RayQuery& query) {
        return tracer.closest_on(instance, *query.ray).has_value();
    }));
}

}  // namespace

float TracedSurroundings::openness(const SurfacePoint& point, const Openness& asked,
                                   const ProbeNumbers& numbers) const {
    if (!(asked.distance > 0.0f) || asked.rays < 1 || point.inside) return 1.0f;
    Vec3f tangent, bitangent;
    orthonormal_basis(asked.axis, tangent, bitangent);
    int hidden = 0;
    for (int first = 0; first < asked.rays; first += static_cast<int>(kPacketSize)) {
        std::array<Maybe<Ray>, kPacketSize> rays;
        std::array<RayQuery, kPacketSize> queries;
        const auto count = static_cast<size_t>(std::min(static_cast<int>(kPacketSize), asked.rays - first));
        for (size_t i = 0; i < count; ++i) {
            const Vec2f random = numbers.get(first + static_cast<int>(i), asked.rays);
            const Vec3f local = cosine_hemisphere(random.x, random.y);
            const Vec3f direction = tangent * local.x + bitangent * local.y + asked.axis * local.z;
            Ray& ray = rays[i].emplace();
            point.release(ray, normalized_or(Vec3d(direction), Vec3d(asked.axis)));
            ray.t_max = static_cast<double>(asked.distance);
            ray.beam = RayBeam::cone(0.0f, kProbeSpread);
            queries[i] = {&ray, kVisibleShadow};
        }
        hidden += asked.only_local ? hidden_locally(tracer_, point.instance, {queries.data(), count})
                                   : std::popcount(tracer_.occluded({queries.data(), count}, Coherence::Incoherent));
    }
    const int open = asked.rays - hidden;
    return static_cast<float>(open) / static_cast<float>(asked.rays);
}

std::optional<Surroundings::Met> TracedSurroundings::cast(const SurfacePoint& point, const Cast& asked) const {
    if (!(asked.distance > 0.0f) || !is_finite(asked.position) || point.inside) return {};
    const Vec3d direction = normalized_or(Vec3d(asked.direction), Vec3d(0, 0, 1));
    Ray ray;
    if (asked.position == Vec3f(point.position)) {
        point.release(ray, direction);
    } else {
        ray.origin = Vec3d(asked.position);
        ray.direction = direction;
        ray.time = point.time;
    }
    ray.t_max = static_cast<double>(asked.distance);
    const Maybe<Hit> hit =
        asked.only_local ? tracer_.closest_on(point.instance, ray) : tracer_.closest(ray, kVisibleAll).hit;
    if (!hit) return {};
    const SurfacePoint other = tracer_.surface_point(ray, *hit, SurfaceDetail::Normal);
    const bool is_behind = other.facet_normal.dot(asked.direction) > 0.0f;
    return Met{static_cast<float>(hit->t), hit->instance == point.instance, is_behind ? -other.normal : other.normal};
}

Vec3f TracedSurroundings::rounded_normal(const SurfacePoint& point, float radius, int rays,
                                         const ProbeNumbers& numbers) const {
    if (!(radius > 0.0f) || !std::isfinite(radius) || rays < 1 || point.inside) return point.normal;
    const CubicDisk disk(radius);
    Vec3f sum(0.0f);
    for (int i = 0; i < rays; ++i) {
        Vec2f random = numbers.get(i, rays);
        const ProbeAxes chosen = choose_axes(point.facet_normal, random.x);
        const float distance = disk.sample(random.x);
        const Vec2f turn = on_circle(random.y);
        const float height = std::sqrt(std::max(radius * radius - distance * distance, 0.0f));
        const Vec3f across = (chosen.axes[1] * turn.x + chosen.axes[2] * turn.y) * distance + chosen.axes[0] * height;
        Ray ray;
        ray.origin = point.position + Vec3d(across);
        ray.time = point.time;
        ray.direction = -Vec3d(chosen.axes[0]);
        ray.t_max = 2.0 * static_cast<double>(height);
        for (int met = 0; met < kMostMeetings; ++met) {
            const Maybe<Hit> hit = tracer_.closest_on(point.instance, ray);
            if (!hit) break;
            const SurfacePoint other = tracer_.surface_point(ray, *hit, SurfaceDetail::Normal);
            const auto reach = static_cast<float>((other.position - point.position).length());
            const float on_disk = disk.density(distance);
            if (on_disk > 0.0f)
                sum += other.normal * (axis_weight(chosen, other.facet_normal) * disk.density(reach) / on_disk);
            ray = other.behind(ray);
            if (!(ray.t_max > 0.0)) break;
        }
    }
    return normalized_or(sum, point.normal);
}

}  // namespace rayleaf
