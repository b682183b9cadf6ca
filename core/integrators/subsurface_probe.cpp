#include "integrators/subsurface_probe.h"

#include "base/circle.h"
#include "base/diagonal_basis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace rayleaf {
namespace {

/// Beyond so many times its width a profile is nothing, as in Cycles.
constexpr float kMostWidths = 16.0f;
/// As many surfaces of the body a probe meets at most; it does not look for those behind.
constexpr size_t kMostHits = 16;

/// What of light has left within `x` widths.
float left_within(float x) {
    return 1.0f - 0.25f * std::exp(-x) - 0.75f * std::exp(-x / 3.0f);
}

/// How much light leaves per unit of distance at `r` by a profile of `width`, of all that does: the paper's equation 3
/// times the circle's length.
float profile(float width, float r) {
    if (r >= kMostWidths * width) return 0.0f;
    const float root = std::exp(-r / (3.0f * width));
    return (root * root * root + root) / (4.0f * width * left_within(kMostWidths));
}

/// The distance within which a share `u` leaves, widths: y = exp(-x / 3) solves y^3 + 3 y = 4 (1 - u).
float distance_of(float u) {
    const float c = 2.0f * (1.0f - u), root = std::sqrt(1.0f + c * c);
    const float y = std::cbrt(c + root) - std::cbrt(root - c);
    return -3.0f * std::log(std::max(y, std::numeric_limits<float>::min()));
}

/// The profiles of the channels that spread.
struct Profiles {
    Color width{0, 0, 0};
    int count = 0;

    explicit Profiles(const Lobe& lobe) {
        for (int c = 0; c < 3; ++c) {
            if (!(lobe.weight[c] > 0.0f) || !(lobe.radius[c] > 0.0f)) continue;
            width[c] = lobe.radius[c];
            ++count;
        }
    }
    /// One of them; what is left of the random number is returned in it.
    float choose(float& random) const {
        const float scaled = random * static_cast<float>(count);
        int left = std::min(static_cast<int>(scaled), count - 1);
        random = scaled - static_cast<float>(left);
        for (int c = 0; c < 3; ++c)
            if (width[c] > 0.0f && left-- == 0) return width[c];
        return 0.0f;
    }
    Color at(float r) const {
        Color result(0.0f);
        for (int c = 0; c < 3; ++c)
            if (width[c] > 0.0f) result[c] = profile(width[c], r);
        return result;
    }
    /// With which `choose` and `distance_of` come to `r`.
    float density(float r) const {
        const Color all = at(r);
        return (all.x + all.y + all.z) / static_cast<float>(count);
    }
};

/// The axes along which a probe may go: the normal, half of the time, or one of two along the surface. Its distance is
/// chosen across its axis, but the profile is asked for the true distance: at corners the result depends on the frame,
/// so it is Cycles'.
struct ProfileAxes {
    std::array<Vec3f, 3> axes;
    size_t chosen;

    ProfileAxes(const Vec3f& normal, float& random) {
        axes[0] = normal;
        diagonal_basis(normal, axes[1], axes[2]);
        chosen = random < 0.5f ? 0 : random < 0.75f ? 1 : 2;
        random = chosen == 0 ? 2.0f * random : 4.0f * random - static_cast<float>(chosen + 1);
    }
    const Vec3f& along() const { return axes[chosen]; }
    const Vec3f& across(size_t i) const { return axes[(chosen + i) % 3]; }
    /// Over the density of the chosen axis, its share by the power heuristic.
    float weight(const Vec3f& facet_normal) const {
        const auto density = [&](size_t i) { return (i == 0 ? 0.5f : 0.25f) * std::abs(axes[i].dot(facet_normal)); };
        float squares = 0.0f;
        for (size_t i = 0; i < 3; ++i) squares += density(i) * density(i);
        return squares > 0.0f ? density(chosen) / squares : 0.0f;
    }
};

struct ProbeHit {
    Hit hit;
    Vec3f facet_normal;
    Color weight;
};

}  // namespace

std::optional<SubsurfaceExit> probe_beside(const Scene& scene, const SubsurfaceStart& start, const Ray& ray) {
    const Profiles profiles(*start.entry.subsurface);
    if (profiles.count == 0) return std::nullopt;
    const SurfacePoint& from = start.vertex.point;
    const Sampler own = start.sampler.branch(0, 1, start.dimension);
    Vec2f random = own.get2(0);
    const ProfileAxes axes(from.facet_normal, random.y);
    const float width = profiles.choose(random.x);
    const float radius = width * distance_of(random.x * left_within(kMostWidths));
    const float farthest = kMostWidths * width,
                height = std::sqrt(std::max(farthest * farthest - radius * radius, 0.0f));
    const Vec2f on_disk = on_circle(random.y) * radius;
    if (!std::isfinite(height)) return std::nullopt;
    Ray probe = ray;
    probe.start = {};
    probe.direction = -Vec3d(axes.along());
    probe.origin =
        from.facet_position + Vec3d(axes.along() * height + axes.across(1) * on_disk.x + axes.across(2) * on_disk.y);
    probe.t_min = 0;
    probe.t_max = 2.0 * static_cast<double>(height);
    const float density = profiles.density(radius);
    std::array<ProbeHit, kMostHits> hits;
    size_t count = 0;
    float sum = 0.0f;
    for (size_t crossed = 0; crossed < kMostHits && density > 0.0f; ++crossed) {
        const Maybe<Hit> hit = scene.tracer().closest_on(from.instance, probe);
        if (!hit) break;
        constexpr double kApart = 1e-6;  // of the probe's length
        const Vec3d place = probe.at(hit->t);
        const Vec3f facet_normal = scene.tracer().surface_point(probe, *hit).facet_normal;
        const auto distance = static_cast<float>((place - from.facet_position).length());
        const Color weight = profiles.at(distance) * (axes.weight(facet_normal) / density);
        probe.t_min = hit->t + kApart * probe.t_max;
        if (!is_finite(weight) || is_black(weight)) continue;
        hits[count++] = {*hit, facet_normal, weight};
        sum += average(weight);
    }
    // One of them, with a chance in proportion to its weight.
    float left = own.get1(1) * sum;
    for (size_t i = 0; i < count; ++i) {
        const float share = average(hits[i].weight);
        left -= share;
        if (left >= 0.0f && i + 1 < count) continue;
        SubsurfaceExit exit{probe, hits[i].hit, hits[i].weight * (sum / share), {}};
        exit.ray.t_min = 0;
        const bool entered_in_front = from.facet_normal.dot(start.vertex.outgoing) > 0.0f;
        exit.outwards = entered_in_front ? hits[i].facet_normal : -hits[i].facet_normal;
        return exit;
    }
    return std::nullopt;
}

}  // namespace rayleaf
