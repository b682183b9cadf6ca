#include "integrators/glass_path.h"

#include "integrators/scattered_differential.h"
#include "ri_tree/output_ray.h"

namespace rayleaf {
namespace {

/// An interpolated exit lies beside the surface by as much as the first hit may: the ray starts this many times as far
/// beyond it, which suffices where it leaves steeper than at some 15 degrees.
constexpr double kExitErrors = 4.0;

struct GlassExit {
    Ray ray;  ///< that leaves
    RayDifferential differential;
    int crossings = 0, total_reflections = 0;  ///< hits from inside: that let the ray out, and that did not
    bool is_cut_off = false;                   ///< by the limit of hits: no ray leaves
};

/// The path through the glass as the hit's ray cache knows it; empty where it does not. `differential`: of the ray that
/// enters, where it hits; so is the one that leaves, unless the cache was asked how the way changes.
std::optional<GlassExit> interpolated_exit(const Scene& scene, const Hit& hit, const RayDifferential& differential,
                                           float time) {
    if (!hit.interpolated || hit.interpolated->way == GlassWay::Unknown) return std::nullopt;
    const Affine3d to_world = scene.tracer().local_to_world(hit.instance, time);
    const InterpolatedHit& way = *hit.interpolated;
    GlassExit exit;
    exit.is_cut_off = way.way == GlassWay::CutOff;
    if (exit.is_cut_off) return exit;
    const Vec3d direction = to_world.vector(way.exit_direction);
    exit.ray.direction = normalized_or(direction, Vec3d(0, 0, 1));
    exit.ray.origin = to_world.point(way.exit_position) +
                      exit.ray.direction * (kExitErrors * way.position_error * to_world.x.length());
    exit.ray.leaves = hit.instance;
    exit.ray.time = time;
    exit.ray.start = {{hit.instance, RayAnchor::kNoFacet, 0}, {}};
    exit.total_reflections = way.total_reflections;
    exit.crossings = way.interior_hits - way.total_reflections;
    exit.differential = differential;
    if (!way.changes.are_known) return exit;
    const auto position_change = [&](size_t i) {
        return Vec3f(to_world.vector(Vec3d(way.changes.steps[i].exit_position)));
    };
    // The map scales evenly: what is at right angles to the direction stays so.
    const auto direction_change = [&](size_t i) {
        return Vec3f(to_world.vector(Vec3d(way.changes.steps[i].exit_direction)) / direction.length());
    };
    exit.differential = {position_change(0), position_change(1), direction_change(0), direction_change(1)};
    return exit;
}

/// The way from `entered`, a ray that just passed the surface of `instance`, of at most so many hits from inside. Empty
/// where it finds no end.
std::optional<GlassExit> traced_exit(const Scene& scene, const GlassBody& body, uint32_t instance, const Ray& entered,
                                     const RayDifferential& differential, int most_hits) {
    GlassExit exit{entered, differential, 0, 0};
    Ray& ray = exit.ray;
    for (int hits = 0; hits < most_hits; ++hits) {
        if (scene.needs_widths()) set_width(ray, exit.differential);
        const Maybe<Hit> hit = scene.tracer().closest_on(instance, ray);
        if (!hit) return std::nullopt;
        const SurfacePoint point = scene.tracer().surface_point(ray, *hit);
        const Vec3d facet(point.facet_normal);
        if (!(ray.direction.dot(facet) > 0.0)) return std::nullopt;  // meets its own outside: no closed body
        const Vec3d normal = -normalized_or(Vec3d(point.normal), facet);
        const std::optional<Vec3d> through =
            normal.dot(ray.direction) < 0.0 ? refracted_direction(ray.direction, normal, body.ior) : ray.direction;
        const Vec3d direction = through ? *through : mirrored(ray.direction, normal);
        LobeSample sample;
        sample.direction = Vec3f(direction);
        sample.kind = through ? LobeKind::Transmission : LobeKind::Glossy;
        sample.singular = true;
        sample.transmitted = through.has_value();
        sample.eta = through ? static_cast<float>(body.ior) : 1.0f;
        const Vec3f incoming(ray.direction);
        exit.differential = scattered_differential(exit.differential.transferred(incoming, hit->t, point.facet_normal),
                                                   incoming, point, sample);
        ++(through ? exit.crossings : exit.total_reflections);
        point.release(ray, direction);
        // Where the ray goes by the facet is where it is: a shading normal may differ from it.
        if (direction.dot(facet) >= 0.0) return exit;
    }
    exit.is_cut_off = true;
    return exit;
}

/// Counts a hit from inside as the bounce that it is; false if the path ends there.
bool cross_inside(LobeKind kind, const Color& factor, const GlassCrosser& path) {
    if (path.bounces.is_last()) return false;
    LobeSample sample;
    sample.kind = kind;
    sample.singular = true;
    sample.transmitted = kind == LobeKind::Transmission;
    path.bounces.scatter(sample);
    path.throughput *= factor;
    return max_abs(path.throughput) > 0.0f;
}

}  // namespace

GlassOutcome cross_glass(const Scene& scene, const Hit& entered, const Vertex& vertex, int most_interior_hits,
                         GlassCrosser path) {
    const uint32_t instance = vertex.point.instance;
    const GlassBody* body = scene.glass_body(instance);
    if (!body) return GlassOutcome::BySurfaces;
    std::optional<GlassExit> exit = interpolated_exit(scene, entered, vertex.differential, vertex.point.time);
    if (!exit) exit = traced_exit(scene, *body, instance, path.ray, path.differential, most_interior_hits);
    if (!exit) return GlassOutcome::BySurfaces;
    if (exit->is_cut_off) return GlassOutcome::Ended;
    for (int i = 0; i < exit->total_reflections; ++i)
        if (!cross_inside(LobeKind::Glossy, body->reflected, path)) return GlassOutcome::Ended;
    for (int i = 0; i < exit->crossings; ++i)
        if (!cross_inside(LobeKind::Transmission, body->leaving, path)) return GlassOutcome::Ended;
    path.ray = exit->ray;
    path.differential = exit->differential;
    return GlassOutcome::Left;
}

ClosestHit outside_glass(const Scene& scene, uint32_t outside_of, Ray& ray, Visibility kind,
                         const RayDifferential* differential, ClosestHit found) {
    constexpr int kMostSurfaces = 4;
    for (int i = 1; i < kMostSurfaces && found.hit && found.hit->instance == outside_of; ++i) {
        const SurfacePoint point = scene.tracer().surface_point(ray, *found.hit);
        if (point.facet_normal.dot(Vec3f(ray.direction)) <= 0.0f) break;
        ray.t_min = found.hit->t + point.start_offset;
        found = scene.tracer().closest(ray, kind, differential);
    }
    return found;
}

}  // namespace rayleaf
