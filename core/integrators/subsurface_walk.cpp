#include "integrators/subsurface_walk.h"

namespace rayleaf {
namespace {

constexpr int kMostScatterings = 256;  // as Cycles
/// What a step uses of the walk's own dimensions.
constexpr uint32_t kDistance = 0, kDirection = 1, kRoulette = 2, kDimensionsPerStep = 4;

/// A colour's share in choosing the channel that a distance is sampled for: by what it would still bring.
Color channel_shares(const Color& throughput, const Color& albedo) {
    const Color brought = throughput * albedo;
    const float sum = brought.x + brought.y + brought.z;
    return sum > 0.0f ? brought / sum : Color(1.0f / 3.0f);
}

int chosen_channel(const Color& shares, float random) {
    if (random < shares.x) return 0;
    return random < shares.x + shares.y ? 1 : 2;
}

/// Henyey and Greenstein's phase function: the cosine to the old direction.
float phase_cosine(float g, float random) {
    constexpr float kEven = 1e-3f;
    if (std::abs(g) < kEven) return 1.0f - 2.0f * random;
    const float k = (1.0f - g * g) / (1.0f - g + 2.0f * g * random);
    return std::clamp((1.0f + g * g - k * k) / (2.0f * g), -1.0f, 1.0f);
}

Vec3f turned(const Vec3f& direction, float cosine, float turn) {
    Vec3f across, up;
    orthonormal_basis(direction, across, up);
    const float sine = std::sqrt(std::max(1.0f - cosine * cosine, 0.0f)), angle = 2.0f * kPi * turn;
    return (across * std::cos(angle) + up * std::sin(angle)) * sine + direction * cosine;
}

Color transmittance(const Color& extinction, float length) {
    return {std::exp(-extinction.x * length), std::exp(-extinction.y * length), std::exp(-extinction.z * length)};
}

/// One ray of the walk, sampled for all channels at once (balance heuristic).
struct Step {
    float length;
    Color shares;

    Step(const SubsurfaceMedium& medium, const Color& throughput, const Vec2f& random)
        : length(0.0f), shares(channel_shares(throughput, medium.albedo)) {
        constexpr float kLeast = 1e-7f;
        const int channel = chosen_channel(shares, random.x);
        length = -std::log(std::max(1.0f - random.y, kLeast)) / medium.extinction[channel];
    }
    Color at_surface(const SubsurfaceMedium& medium, float t) const {
        const Color left = transmittance(medium.extinction, t);
        const float density = shares.dot(left);
        return density > 0.0f ? left / density : Color(0.0f);
    }
    Color scattered(const SubsurfaceMedium& medium) const {
        const Color met = medium.extinction * transmittance(medium.extinction, length);
        const float density = shares.dot(met);
        return density > 0.0f ? met * medium.albedo / density : Color(0.0f);
    }
};

/// After some scatterings direction is forgotten: isotropic ones that lead as far are fewer (Wyman et al. 1989,
/// similarity relations; Cycles does so after as many).
constexpr uint32_t kRememberedScatterings = 9;

SubsurfaceMedium isotropic(const SubsurfaceMedium& medium) {
    SubsurfaceMedium result = medium;
    const Color scattering = medium.extinction * medium.albedo;
    result.extinction = medium.extinction - scattering * medium.anisotropy;
    result.albedo = scattering * (1.0f - medium.anisotropy) / result.extinction;
    result.anisotropy = 0;
    return result;
}

bool survives(Color& throughput, float random) {
    constexpr float kCertain = 0.5f;
    const float largest = max_component(throughput);
    if (!(largest > 0.0f) || !is_finite(throughput)) return false;
    if (largest >= kCertain) return true;
    const float survival = largest / kCertain;
    if (random >= survival) return false;
    throughput /= survival;
    return true;
}

/// What light leaves by that entered by `entered`.
Lobe exit_lobe(const Vertex& vertex, const Lobe& entered) {
    Lobe lobe;
    const bool faces = vertex.point.facet_normal.dot(vertex.outgoing) > 0.0f;
    lobe.normal = faces ? vertex.point.normal : -vertex.point.normal;
    for (int i = 0; i < vertex.closures.size(); ++i)
        if (vertex.closures[i].type == LobeType::Subsurface) lobe.normal = vertex.closures[i].normal;
    lobe.type = entered.fresnel == Lobe::Fresnel::Schlick ? LobeType::LambertExit : LobeType::Diffuse;
    lobe.weight = Color(1.0f);
    return lobe;
}

}  // namespace

std::optional<SubsurfaceExit> walk_below(const Scene& scene, const SubsurfaceEntry& entry, const Sampler& sampler,
                                         uint32_t dimension) {
    const SubsurfaceMedium later = isotropic(entry.medium);
    const Sampler own = sampler.branch(0, 1, dimension);
    Ray ray = entry.ray;
    Color throughput(1.0f);
    for (uint32_t step = 0; step < kMostScatterings; ++step) {
        const SubsurfaceMedium& medium = step <= kRememberedScatterings ? entry.medium : later;
        const uint32_t first = step * kDimensionsPerStep;
        const Step taken(medium, throughput, own.get2(first + kDistance));
        ray.t_max = taken.length;
        if (const Maybe<Hit> hit = scene.tracer().closest_on(entry.instance, ray))
            return SubsurfaceExit{ray, *hit, throughput * taken.at_surface(medium, static_cast<float>(hit->t))};
        throughput *= taken.scattered(medium);
        if (!survives(throughput, own.get1(first + kRoulette))) return std::nullopt;
        const Vec2f random = own.get2(first + kDirection);
        const Vec3f direction(ray.direction);
        Ray next = entry.ray;  // its width
        next.start = {};
        next.t_min = 0;
        next.origin = ray.origin + ray.direction * static_cast<double>(taken.length);
        next.direction =
            normalized_or(Vec3d(turned(direction, phase_cosine(medium.anisotropy, random.x), random.y)), ray.direction);
        ray = next;
    }
    return std::nullopt;
}

std::optional<SubsurfaceVertex> leave_below(const Scene& scene, const SubsurfaceStart& start) {
    const Vertex& from = start.vertex;
    SubsurfaceEntry entry;
    entry.instance = from.point.instance;
    entry.medium = subsurface_medium(*start.entry.subsurface);
    from.point.release(entry.ray, normalized_or(Vec3d(start.entry.direction), Vec3d(0, 0, 1)));
    if (scene.needs_widths()) set_width(entry.ray, from.differential);
    const std::optional<SubsurfaceExit> exit = walk_below(scene, entry, start.sampler, start.dimension);
    if (!exit) return std::nullopt;
    SubsurfaceVertex found;
    found.throughput = start.entry.weight * entry.medium.factor * exit->throughput;
    Vertex& vertex = found.vertex;
    vertex.point = scene.tracer().surface_point(exit->ray, exit->hit);
    vertex.differential = from.differential;
    // Evaluated as seen from outside: the material may bend the normal by which light leaves.
    vertex.outgoing = Vec3f(exit->ray.direction);
    scene.shade(vertex.point, vertex.outgoing, vertex.differential, start.state, vertex.closures);
    const Lobe lobe = exit_lobe(vertex, *start.entry.subsurface);
    vertex.closures.clear();
    vertex.closures.add(lobe);
    vertex.look();
    return found;
}

}  // namespace rayleaf
