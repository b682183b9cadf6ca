#include "integrators/shadow.h"

#include "integrators/medium_tracking.h"
#include "integrators/volumes.h"

#include <algorithm>
#include <array>
#include <utility>

namespace rayleaf {
namespace {

/// From a facet that is shaded smooth to the surface that it stands for, or part of the way, where light grazes it. By
/// share as Cycles does it: all of it where the mean of both sines is below half the cutoff, nothing above it.
Vec3d way_to_smooth_surface(const Scene& scene, const SurfacePoint& point, const Vec3f& direction) {
    const float cutoff = scene.shadow_terminator(point.instance);
    const float by_normal = direction.dot(point.normal), side = by_normal > 0.0f ? 1.0f : -1.0f;
    const float by_facet = side * direction.dot(point.facet_normal);
    const float share =
        std::abs(by_normal) < cutoff ? 2.0f - (by_facet + std::abs(by_normal)) / cutoff : 1.0f - by_facet / cutoff;
    if (!(cutoff > 0.0f && share > 0.0f)) return Vec3d(0.0);
    const Vec3d rise = point.shape->rise(point.local);
    if (rise == Vec3d(0.0)) return rise;
    const Vec3d way = scene.tracer().local_to_world(point.instance, point.time).vector(rise);
    // Where it is hollow the facet is nearer to the light.
    if (!(way.dot(Vec3d(point.facet_normal)) * side > 0.0)) return Vec3d(0.0);
    return way * double{std::min(share, 1.0f)};
}

/// Where a shadow ray starts. Near the terminator a facet may face away from a light that the surface itself still
/// sees, or stand in the light of its neighbour where the two meet in a dent. The facet's point would then lie in
/// shadow, in steps as large as facets; the surface's own point lies outside all facets around it where the surface is
/// convex.
Vec3d shadow_origin(const Scene& scene, const SurfacePoint& point, const Vec3f& direction) {
    /// Sine of the angle to a facet and to the surface above which neighbours never matter: facets of a tenth of a
    /// pixel meet at less. At a pole they are narrow, and may be turned farther from the surface than that.
    constexpr float kGrazing = 0.1f;
    const float by_facet = direction.dot(point.facet_normal), by_surface = direction.dot(point.normal);
    const Vec3d side = Vec3d(point.normal) * (by_surface > 0.0f ? 1.0 : -1.0);
    const Vec3d way = point.shape ? way_to_smooth_surface(scene, point, direction) : Vec3d(0.0);
    if (way != Vec3d(0.0)) return point.facet_position + way + side * point.start_offset;
    if (by_facet * by_surface > 0.0f && std::min(std::abs(by_facet), std::abs(by_surface)) > kGrazing)
        return point.ray_origin(direction);
    const double rise = (point.position - point.facet_position).dot(side);
    // Corners and edges of facets lie on the surface, but for rounding.
    if (rise < -point.facet_error) return point.ray_origin(direction);
    return (rise > 0.0 ? point.position : point.facet_position) + side * point.start_offset;
}

}  // namespace

bool set_shadow_ray(const Scene& scene, const SurfacePoint& point, const LightSample& light, Ray& ray) {
    if (!light.casts_shadow) return false;
    ray.t_min = scene.shadow_bias();
    point.release(ray, light.direction);
    const Vec3d origin = shadow_origin(scene, point, light.direction);
    if (origin != ray.origin) ray.start.facet = RayAnchor::kNone;  // beside it
    ray.origin = origin;
    ray.end = light.target_anchor;
    if (!std::isfinite(light.distance)) {
        ray.direction = normalized_or(Vec3d(light.direction), Vec3d(0, 0, 1));
        return true;
    }
    // From the very start to the very end, both off their facets: a ray parallel to the sampled direction would miss
    // the end by the start's offset.
    const Vec3d way = light.target - ray.origin;
    ray.t_max = way.length();
    // A length out of range says nothing of the direction.
    ray.direction = std::isnormal(ray.t_max) ? way * (1.0 / ray.t_max) : normalized_or(way, Vec3d(light.direction));
    return ray.t_max > 0;
}

namespace {

/// Up to where the ray meets something, if it does.
Color through_media(const Scene& scene, FreeWay& way, const std::optional<Hit>& hit) {
    if (way.media.empty()) return Color(1.0f);
    const MediumSegment segment{scene, way.media, way.ray, hit ? hit->t : way.ray.t_max, way.state};
    return transmittance(segment, way.random);
}

/// Behind a surface, to the same end. A parallel ray would end beside it, and that may be behind what shines there.
Ray behind(const SurfacePoint& point, const Ray& ray) {
    Ray rest = point.behind(ray);
    if (!std::isfinite(ray.t_max) || !(rest.t_max > 0.0)) return rest;
    const Vec3d way = ray.at(ray.t_max) - rest.origin;
    rest.direction = normalized_or(way, ray.direction);
    rest.t_max = way.length();
    return rest;
}

bool lets_through(const Material& material, Visibility kind) {
    return material.surface->may_be_transparent() && (material.transparent_shadow || !is_shadow_ray(kind));
}

/// What the surface lets through; the way then goes on behind it.
Color through_surface(const Scene& scene, FreeWay& way, const Hit& hit) {
    const Vec3f direction(way.ray.direction);
    const SurfacePoint point = scene.tracer().surface_point(way.ray, hit);
    way.state.ray_length += static_cast<float>(hit.t);
    way.differential = way.differential.transferred(direction, hit.t, point.facet_normal);
    Color share(1.0f);
    if (!scene.material(hit.instance, hit.local).bounds_medium_alone) {
        Closures closures;
        scene.shade(point, -direction, way.differential, way.state, closures);
        share = closures.transparency;
        ++way.state.transparent_depth;
        --way.transparent_left;
    }
    cross(scene, point, direction, way.media);
    way.ray = with_width(behind(point, way.ray), way.differential, way.widening);
    return share;
}

/// A packet's, where something may let light through: most rays meet nothing, or what lets nothing through.
void shares_through_surfaces(const Scene& scene, std::span<FreeWay* const> ways, std::span<const RayQuery> rays,
                             Coherence coherence, Color* shares) {
    std::array<ClosestHit, kPacketSize> nearest;
    scene.tracer().closest(rays, coherence, nearest.data());
    for (size_t i = 0; i < ways.size(); ++i) {
        FreeWay& way = *ways[i];
        const std::optional<Hit>& hit = nearest[i].hit;
        if (!hit) {
            shares[i] = through_volumes(scene, way.ray, way.kind).transmittance;
            continue;
        }
        const Material& material = scene.material(hit->instance, hit->local);
        const bool opaque = !material.bounds_medium_alone && !lets_through(material, way.kind);
        shares[i] = opaque ? Color(0.0f) : free_share(scene, std::move(way));
    }
}

}  // namespace

void free_shares_of_packet(const Scene& scene, std::span<FreeWay* const> ways, Coherence coherence, Color* shares) {
    std::array<RayQuery, kPacketSize> queries;
    bool any_media = false;
    for (size_t i = 0; i < ways.size(); ++i) {
        FreeWay& way = *ways[i];
        if (scene.needs_footprints()) way.ray = with_width(way.ray, way.differential, way.widening);
        queries[i] = {&way.ray, way.kind, nullptr};
        any_media |= !way.media.empty();
    }
    if (any_media) {
        for (size_t i = 0; i < ways.size(); ++i) shares[i] = free_share(scene, std::move(*ways[i]));
        return;
    }
    const std::span<const RayQuery> rays(queries.data(), ways.size());
    if (scene.has_transparency()) return shares_through_surfaces(scene, ways, rays, coherence, shares);
    const uint32_t hidden = scene.tracer().occluded(rays, coherence);
    for (size_t i = 0; i < ways.size(); ++i)
        shares[i] =
            (hidden >> i & 1u) != 0 ? Color(0.0f) : through_volumes(scene, ways[i]->ray, ways[i]->kind).transmittance;
}

void free_shares(const Scene& scene, std::span<FreeWay> ways, Coherence coherence, Color* shares) {
    std::array<FreeWay*, kPacketSize> packet;
    for (size_t first = 0; first < ways.size(); first += kPacketSize) {
        const size_t count = std::min<size_t>(kPacketSize, ways.size() - first);
        for (size_t i = 0; i < count; ++i) packet[i] = &ways[first + i];
        free_shares_of_packet(scene, {packet.data(), count}, coherence, shares + first);
    }
}

Color free_share(const Scene& scene, FreeWay way) {
    way.ray = with_width(way.ray, way.differential, way.widening);
    Color share = through_volumes(scene, way.ray, way.kind).transmittance;
    if (!scene.has_transparency() && way.media.empty())
        return scene.tracer().occluded(way.ray, way.kind) ? Color(0.0f) : share;
    /// A ray that never gets through the borders of media stops somewhere.
    constexpr int kMostSurfaces = 2048;
    for (int i = 0; i < kMostSurfaces; ++i) {
        const std::optional<Hit> hit = scene.tracer().closest_hit(way.ray, way.kind);
        if (hit) {
            const Material& material = scene.material(hit->instance, hit->local);
            const bool is_surface = !material.bounds_medium_alone;
            if (is_surface && (way.transparent_left <= 0 || !lets_through(material, way.kind))) return Color(0.0f);
        }
        share *= through_media(scene, way, hit);
        if (!hit) return share;
        share *= through_surface(scene, way, *hit);
        if (!(max_component(share) > 0.0f)) return Color(0.0f);
    }
    return Color(0.0f);
}

}  // namespace rayleaf
