#include "integrators/subsurface_walk.h"

#include "integrators/medium_weights.h"
#include "integrators/subsurface_probe.h"

namespace rayleaf {
namespace {

constexpr int kMostScatterings = 256;  // as Cycles
/// What a step uses of the walk's own dimensions.
constexpr uint32_t kDistance = 0, kDirection = 1, kRoulette = 2, kTechnique = 3, kDimensionsPerStep = 4;

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
    constexpr float kCertain = 0.1f;
    const float largest = max_abs(throughput);
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
    // So many diffusion lengths below, the other side of the body is not felt.
    constexpr float kFeltLengths = 4.0f;
    const GuidedMedium remembering(entry.medium);
    std::optional<GuidedMedium> forgetting;  // few walks go on so long
    const Sampler own = sampler.branch(0, 1, dimension);
    const auto depth_of = [&](const Vec3d& place) { return (entry.ray.origin - place).dot(Vec3d(entry.normal)); };
    SubsurfaceGuide guide(entry.normal);
    Ray ray = entry.ray;
    Color throughput(1.0f);
    for (uint32_t step = 0; step < kMostScatterings; ++step) {
        if (step == kRememberedScatterings + 1) forgetting.emplace(isotropic(entry.medium));
        const GuidedMedium& medium = forgetting ? *forgetting : remembering;
        const uint32_t first = step * kDimensionsPerStep;
        const Color shares = shares_of(throughput * entry.carried * medium.medium().albedo);
        const Vec2f distance = own.get2(first + kDistance);
        float length = 0.0f;
        if (step == 0) {
            length = guide.begin(medium, shares, distance);
            ray.t_max = std::max(length, kFeltLengths * medium.diffusion_length());
        } else {
            const StepNumbers numbers{distance, own.get2(first + kDirection), own.get1(first + kTechnique)};
            const GuidedStep taken = guide.sample(medium, depth_of(ray.origin), Vec3f(ray.direction), shares, numbers);
            ray.direction = normalized_or(Vec3d(taken.direction), ray.direction);
            ray.t_max = length = taken.length;
        }
        const Maybe<Hit> hit = scene.tracer().closest_on(entry.instance, ray);
        if (hit && hit->t <= static_cast<double>(length))
            return SubsurfaceExit{ray, *hit, throughput * guide.at_surface(static_cast<float>(hit->t)),
                                  Vec3f(ray.direction)};
        if (hit) guide.set_thickness(depth_of(ray.at(hit->t)));
        throughput *= guide.scattered();
        if (!survives(throughput, own.get1(first + kRoulette))) return std::nullopt;
        Ray next = entry.ray;  // its width
        next.start = {};
        next.t_min = 0;
        next.origin = ray.at(static_cast<double>(length));
        next.direction = ray.direction;
        ray = next;
    }
    return std::nullopt;
}

std::optional<SubsurfaceVertex> leave_below(const Scene& scene, const SubsurfaceStart& start) {
    const Vertex& from = start.vertex;
    SubsurfaceEntry entry;
    entry.instance = from.point.instance;
    entry.medium = subsurface_medium(*start.entry.subsurface);
    entry.carried = start.entry.weight * entry.medium.factor;
    const Vec3f& facet = from.point.facet_normal;
    entry.normal = facet.dot(start.entry.direction) > 0.0f ? -facet : facet;
    from.point.release(entry.ray, normalized_or(Vec3d(start.entry.direction), Vec3d(0, 0, 1)));
    if (scene.needs_widths()) set_width(entry.ray, from.differential);
    const bool by_profile = start.entry.subsurface->by_profile;
    const std::optional<SubsurfaceExit> exit =
        by_profile ? probe_beside(scene, start, entry.ray) : walk_below(scene, entry, start.sampler, start.dimension);
    if (!exit) return std::nullopt;
    SubsurfaceVertex found;
    found.throughput = (by_profile ? start.entry.weight : entry.carried) * exit->throughput;
    Vertex& vertex = found.vertex;
    vertex.point = scene.tracer().surface_point(exit->ray, exit->hit);
    vertex.differential = from.differential;
    // Evaluated as seen from outside: the material may bend the normal by which light leaves.
    vertex.outgoing = exit->outwards;
    scene.shade(vertex.point, vertex.outgoing, vertex.differential, start.state, vertex.closures);
    const Lobe lobe = exit_lobe(vertex, *start.entry.subsurface);
    vertex.closures.clear();
    vertex.closures.add(lobe);
    vertex.look();
    return found;
}

}  // namespace rayleaf
