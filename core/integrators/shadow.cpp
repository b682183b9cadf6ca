#include "integrators/shadow.h"

#include "integrators/volumes.h"

namespace rayleaf {
namespace {

/// Where a shadow ray starts. Near the terminator a facet may face away from a light that the surface itself still
/// sees, or stand in the light of its neighbour where the two meet in a dent. The facet's point would then lie in
/// shadow, in steps as large as facets; the surface's own point lies outside all facets around it where the surface is
/// convex.
Vec3d shadow_origin(const SurfacePoint& point, const Vec3f& direction) {
    /// Sine of the angle to a facet and to the surface above which neighbours never matter: facets of a tenth of a
    /// pixel meet at less. At a pole they are narrow, and may be turned farther from the surface than that.
    constexpr float kGrazing = 0.1f;
    const float by_facet = direction.dot(point.facet_normal), by_surface = direction.dot(point.normal);
    if (by_facet * by_surface > 0.0f && std::min(std::abs(by_facet), std::abs(by_surface)) > kGrazing)
        return point.ray_origin(direction);
    const Vec3d side = Vec3d(point.normal) * (by_surface > 0.0f ? 1.0 : -1.0);
    const double rise = (point.position - point.facet_position).dot(side);
    // Corners and edges of facets lie on the surface, but for rounding.
    if (rise < -point.facet_error) return point.ray_origin(direction);
    return (rise > 0.0 ? point.position : point.facet_position) + side * point.start_offset;
}

}  // namespace

std::optional<Ray> shadow_ray(const Scene& scene, const SurfacePoint& point, const LightSample& light) {
    if (!light.casts_shadow) return std::nullopt;
    Ray ray;
    ray.t_min = scene.shadow_bias();
    point.release(ray, light.direction);
    ray.origin = shadow_origin(point, light.direction);
    ray.end = light.target_anchor;
    ray.direction = normalized_or(Vec3d(light.direction), Vec3d(0, 0, 1));
    if (!std::isfinite(light.distance)) return ray;
    // From the very start to the very end, both off their facets: a ray parallel to the sampled direction would miss
    // the end by the start's offset.
    const Vec3d way = light.target - ray.origin;
    ray.direction = normalized_or(way, ray.direction);
    ray.t_max = way.length();
    if (!(ray.t_max > 0)) return std::nullopt;
    return ray;
}

Color free_share(const Scene& scene, Ray ray, RayDifferential differential, Visibility kind, PathState state,
                 int transparent_left, const RayWidening& widening) {
    ray = with_width(ray, differential, widening);
    Color transmittance = through_volumes(scene, ray, kind).transmittance;
    if (!scene.has_transparency()) return scene.tracer().occluded(ray, kind) ? Color(0.0f) : transmittance;
    const Vec3f outgoing = -Vec3f(ray.direction);
    for (int left = transparent_left;; --left) {
        const std::optional<Hit> hit = scene.tracer().closest_hit(ray, kind);
        if (!hit) return transmittance;
        if (left <= 0 || !scene.material(hit->instance, hit->local).surface->may_be_transparent()) return Color(0.0f);
        const SurfacePoint point = scene.tracer().surface_point(ray, *hit);
        state.ray_length += static_cast<float>(hit->t);
        differential = differential.transferred(Vec3f(ray.direction), hit->t, point.facet_normal);
        Closures closures;
        scene.shade(point, outgoing, differential, state, closures);
        transmittance *= closures.transparency;
        if (!(max_component(transmittance) > 0.0f)) return Color(0.0f);
        ++state.transparent_depth;
        ray = with_width(point.behind(ray), differential, widening);
    }
}

Color shadow_transmittance(const Scene& scene, const SurfacePoint& point, const LightSample& light,
                           const RayDifferential& differential, const Bounces& bounces, const RayWidening& widening) {
    const std::optional<Ray> ray = shadow_ray(scene, point, light);
    if (!ray) return Color(1.0f);
    return free_share(scene, *ray, differential, kVisibleShadow, bounces.of_shadow_ray(), bounces.transparent_left(),
                      widening);
}

}  // namespace rayleaf
