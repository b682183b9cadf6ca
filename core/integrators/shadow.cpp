#include "integrators/shadow.h"

#include "integrators/medium_tracking.h"
#include "integrators/vertex.h"
#include "integrators/volumes.h"

#include <algorithm>
#include <array>
#include <functional>
#include <vector>

namespace rayleaf {
namespace {

/// From a facet that is shaded smooth to the surface that it stands for, or part of the way, where light grazes it. By
/// share as Cycles does it: all of it where the mean of both sines is below half the cutoff, nothing above it.
Vec3d way_to_smooth_surface(const Scene& scene, const SurfacePoint& point, const Vec3f& direction) {
    const float cutoff = scene.shadow_terminator(point.instance);
    const float by_normal = direction.dot(point.normal), side = by_normal > 0.0f ? 1.0f : -1.0f;
    const float by_facet = side * direction.dot(point.facet_normal);
    const float rest =  // the share times the cutoff
        std::abs(by_normal) < cutoff ? 2.0f * cutoff - (by_facet + std::abs(by_normal)) : cutoff - by_facet;
    if (!(cutoff > 0.0f && rest > 0.0f)) return Vec3d(0.0);
    const Vec3d rise = point.shape->rise(point.local);
    if (rise == Vec3d(0.0)) return rise;
    const Vec3d way = scene.tracer().local_to_world(point.instance, point.time).vector(rise);
    // Where it is hollow the facet is nearer to the light.
    if (!(way.dot(Vec3d(point.facet_normal)) * side > 0.0)) return Vec3d(0.0);
    return way * double{std::min(rest / cutoff, 1.0f)};
}

/// Moves the origin of a shadow ray that was released from the point towards `direction`, or nearly so, if it has to
/// start elsewhere. Near the terminator a facet may face away from a light that the surface itself still sees, or stand
/// in the light of its neighbour where the two meet in a dent. The facet's point would then lie in shadow, in steps as
/// large as facets; the surface's own point lies outside all facets around it where the surface is convex.
void move_origin(const Scene& scene, const SurfacePoint& point, const Vec3f& direction, Ray& ray) {
    /// Sine of the angle to a facet and to the surface above which neighbours never matter: facets of a tenth of a
    /// pixel meet at less. At a pole they are narrow, and may be turned farther from the surface than that.
    constexpr float kGrazing = 0.1f;
    const float by_facet = direction.dot(point.facet_normal), by_surface = direction.dot(point.normal);
    if (point.shape && point.shape->kind() == ShapeKind::Strands) return;  // it has no facets
    const bool is_flat = point.shape && point.shape->kind() == ShapeKind::TriangleMesh;
    const Vec3d way = is_flat ? way_to_smooth_surface(scene, point, direction) : Vec3d(0.0);
    const bool is_smoothed = way != Vec3d(0.0);
    const bool is_open = by_facet * by_surface > 0.0f && std::min(std::abs(by_facet), std::abs(by_surface)) > kGrazing;
    if (is_open && !is_smoothed) return;
    const Vec3d side = Vec3d(point.normal) * (by_surface > 0.0f ? 1.0 : -1.0);
    const Vec3d facet_normal(point.facet_normal);
    const double facet_side = facet_normal.dot(side) > 0.0 ? 1.0 : -1.0;
    // Above the facet's plane, not along the surface's normal: the surface's point also lies beside the facet's.
    const double rise = (point.position - point.facet_position).dot(facet_normal) * facet_side;
    // Corners and edges of facets lie on the surface, but for rounding. Where a facet lies above the surface, that is
    // hollow, and light from behind the facet does not come: a ray from its back would start inside the body.
    const bool is_behind = (ray.direction.dot(facet_normal) > 0.0) != (by_surface > 0.0f);
    if (!is_smoothed && rise < -point.facet_error && !is_behind) return;
    const Vec3d start = is_smoothed ? point.facet_position + way : rise > 0.0 ? point.position : point.facet_position;
    ray.origin = start + side * point.start_offset;
    ray.start.facet = RayAnchor::kNone;  // beside it
}

}  // namespace

bool set_shadow_ray(const Scene& scene, const SurfacePoint& point, const LightSample& light, Ray& ray) {
    if (!light.casts_shadow) return false;
    ray.t_min = scene.shadow_bias();
    const bool is_far = !std::isfinite(light.distance);
    // From the facet: the light was sampled from the surface, and its direction from there may lie on the facet's other
    // side.
    const Vec3d sampled = ray_direction(light.direction);
    point.release(ray, is_far ? sampled : normalized_or(light.target - point.facet_position, sampled));
    move_origin(scene, point, light.direction, ray);
    ray.end = light.target_anchor;
    if (is_far) return true;
    // From the very start to the very end, both off their facets: a ray parallel to the sampled direction would miss
    // the end by the start's offset.
    const Vec3d way = light.target - ray.origin;
    ray.t_max = way.length();
    // A length out of range says nothing of the direction.
    ray.direction = std::isnormal(ray.t_max) ? way * (1.0 / ray.t_max) : normalized_or(way, sampled);
    return ray.t_max > 0;
}

namespace {

/// A way that goes on, and what it meets next.
struct FollowedWay {
    FreeWay* way;
    Color* share;  ///< of what gets through, up to here
    const Hit* hit = nullptr;
    const Material* material = nullptr;
    const PassedHits* passed = nullptr;  ///< all that is on the way, where it is known
    double from = 0;                     ///< t of the last surface on the ray
};

/// Up to where the ray meets something, if it does.
Color through_media(const Scene& scene, FreeWay& way, const Hit* hit) {
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

bool lets_through(const Material& material, const FreeWay& way) {
    if (material.bounds_medium_alone) return true;
    return way.transparent_left > 0 && material.surface->may_be_transparent() &&
           (material.transparent_shadow || !is_shadow_ray(way.kind));
}

/// True if the way may go on behind what it meets.
bool may_go_on(const Scene& scene, FollowedWay& each) {
    FreeWay& way = *each.way;
    if (each.hit) {
        each.material = &scene.material(each.hit->instance, each.hit->local);
        if (!lets_through(*each.material, way)) {
            *each.share = Color(0.0f);
            return false;
        }
    }
    *each.share *= through_media(scene, way, each.hit);
    return each.hit != nullptr;
}

/// What surfaces of one material let through.
void shade(const Scene& scene, std::span<const FollowedWay> followed, const SurfacePoint* points) {
    // As many as are needed: a packet of them is more than a core's nearest cache has room for.
    std::vector<ShadingInputs> inputs(followed.size());
    std::vector<Closures> closures(followed.size());
    std::array<const ShadingInputs*, kPacketSize> of_point;
    std::array<Closures*, kPacketSize> results;
    const Material& material = *followed.front().material;
    for (size_t i = 0; i < followed.size(); ++i) {
        FreeWay& way = *followed[i].way;
        inputs[i] = scene.shading_inputs(points[i], material, -Vec3f(way.ray.direction), way.differential, way.state);
        of_point[i] = &inputs[i];
        results[i] = &closures[i];
    }
    material.surface->evaluate({of_point.data(), followed.size()}, {results.data(), followed.size()});
    for (size_t i = 0; i < followed.size(); ++i) {
        *followed[i].share *= closures[i].shadow_transparency();
        ++followed[i].way->state.transparent_depth;
        --followed[i].way->transparent_left;
    }
}

/// What the ways have met takes its share. They are put in order: each program runs for all points of its material.
std::vector<SurfacePoint> cross_surfaces(const Scene& scene, std::span<FollowedWay> followed) {
    std::vector<SurfacePoint> points(followed.size());
    std::array<SurfaceQuery, kPacketSize> surfaces;
    std::ranges::sort(followed, std::less<>(), &FollowedWay::material);
    for (size_t i = 0; i < followed.size(); ++i) surfaces[i] = {&followed[i].way->ray, followed[i].hit, &points[i]};
    const SurfaceDetail detail = scene.needs_footprints() ? SurfaceDetail::Curvature : SurfaceDetail::Normal;
    scene.tracer().surface_points({surfaces.data(), followed.size()}, detail);
    for (size_t i = 0; i < followed.size(); ++i) {
        FreeWay& way = *followed[i].way;
        const double length = points[i].t - followed[i].from;
        way.state.ray_length += static_cast<float>(length);
        if (scene.needs_footprints())
            way.differential = way.differential.transferred(Vec3f(way.ray.direction), length, points[i].facet_normal);
    }
    for (size_t first = 0, end = 0; first < followed.size(); first = end) {
        const Material* material = followed[first].material;
        while (end < followed.size() && followed[end].material == material) ++end;
        if (!material->bounds_medium_alone) shade(scene, followed.subspan(first, end - first), &points[first]);
    }
    return points;
}

/// Keeps those through which light may come; how many.
size_t keep_open(std::span<FollowedWay> followed) {
    size_t left = 0;
    for (const FollowedWay& each : followed)
        if (max_component(*each.share) > 0.0f)
            followed[left++] = each;
        else
            *each.share = Color(0.0f);
    return left;
}

/// The ways go on behind what they have met.
void go_behind(const Scene& scene, std::span<FollowedWay> followed) {
    const std::vector<SurfacePoint> points = cross_surfaces(scene, followed);
    for (size_t i = 0; i < followed.size(); ++i) {
        FreeWay& way = *followed[i].way;
        cross(scene, points[i], Vec3f(way.ray.direction), way.media);
        way.ray = behind(points[i], way.ray);
        if (scene.needs_widths()) set_width(way.ray, way.differential, way.widening);
    }
}

/// The first of them, as many as the result says, are those that go on behind what they meet.
size_t pass_next(const Scene& scene, std::span<FollowedWay> going, Coherence coherence) {
    std::array<RayQuery, kPacketSize> rays;
    std::array<ClosestHit, kPacketSize> nearest;
    for (size_t i = 0; i < going.size(); ++i) rays[i] = {&going[i].way->ray, going[i].way->kind, nullptr};
    if (going.size() == 1)
        nearest[0] = scene.tracer().closest(*rays[0].ray, rays[0].kind, nullptr);
    else
        scene.tracer().closest({rays.data(), going.size()}, coherence, nearest.data());
    size_t met = 0;
    for (size_t i = 0; i < going.size(); ++i) {
        FollowedWay each{going[i].way, going[i].share, nearest[i].hit ? &*nearest[i].hit : nullptr};
        if (may_go_on(scene, each)) going[met++] = each;
    }
    if (met == 0) return 0;
    go_behind(scene, going.first(met));
    return keep_open(going.first(met));
}

/// Ways of which all surfaces are known, one surface of each after the other.
void pass_known(const Scene& scene, std::span<FollowedWay> ways) {
    std::array<Hit, kPacketSize> hits;
    size_t left = ways.size();
    for (size_t number = 0; left > 0; ++number) {
        size_t met = 0;
        for (FollowedWay each : ways.first(left)) {
            if (number == each.passed->hits().size()) continue;
            hits[met] = scene.tracer().hit_of(each.way->ray, each.passed->hits()[number]);
            each.hit = &hits[met];
            if (may_go_on(scene, each)) ways[met++] = each;
        }
        cross_surfaces(scene, ways.first(met));
        for (FollowedWay& each : ways.first(met)) each.from = each.hit->t;
        left = keep_open(ways.first(met));
    }
}

/// Looks for all surfaces on the ways at once. The first ways, as many as the result says, have more on them than that
/// tells.
size_t pass_at_once(const Scene& scene, std::span<FollowedWay> going, Coherence coherence) {
    // There, distances between surfaces count, and borders.
    const auto in_media = [](const FollowedWay& each) { return !each.way->media.empty(); };
    const auto first = std::partition(going.begin(), going.end(), in_media);
    const std::span<FollowedWay> asked = going.subspan(static_cast<size_t>(first - going.begin()));
    if (asked.empty()) return going.size();
    std::array<RayQuery, kPacketSize> rays;
    std::array<PassedHits, kPacketSize> passed;
    for (size_t i = 0; i < asked.size(); ++i) {
        rays[i] = {&asked[i].way->ray, asked[i].way->kind, nullptr};
        passed[i].start(asked[i].way->transparent_left);
    }
    scene.tracer().pass({rays.data(), asked.size()}, coherence, passed.data());
    std::array<FollowedWay, kPacketSize> known;
    size_t known_count = 0, unknown = going.size() - asked.size();
    for (size_t i = 0; i < asked.size(); ++i) {
        if (passed[i].is_closed()) {
            *asked[i].share = Color(0.0f);
        } else if (passed[i].is_unknown()) {
            going[unknown++] = asked[i];
        } else {
            known[known_count] = asked[i];
            known[known_count++].passed = &passed[i];
        }
    }
    pass_known(scene, {known.data(), known_count});
    return unknown;
}

/// Where something may let light through.
void follow(const Scene& scene, std::span<FreeWay* const> ways, Coherence coherence, Color* shares) {
    /// A ray that never gets through the borders of media stops somewhere.
    constexpr int kMostSurfaces = 2048;
    std::array<FollowedWay, kPacketSize> going;
    size_t count = ways.size();
    for (size_t i = 0; i < count; ++i) {
        shares[i] = free_of_volumes(scene, ways[i]->ray, ways[i]->kind);
        going[i] = {ways[i], &shares[i]};
    }
    if (scene.finds_passages()) count = pass_at_once(scene, {going.data(), count}, coherence);
    for (int i = 0; i < kMostSurfaces && count > 0; ++i) count = pass_next(scene, {going.data(), count}, coherence);
    for (size_t i = 0; i < count; ++i) *going[i].share = Color(0.0f);
}

}  // namespace

void free_shares_of_packet(const Scene& scene, std::span<FreeWay* const> ways, Coherence coherence, Color* shares) {
    std::array<RayQuery, kPacketSize> rays;
    bool may_pass = scene.has_transparency();
    for (size_t i = 0; i < ways.size(); ++i) {
        FreeWay& way = *ways[i];
        if (scene.needs_widths()) set_width(way.ray, way.differential, way.widening);
        rays[i] = {&way.ray, way.kind, nullptr};
        may_pass |= !way.media.empty();
    }
    if (may_pass) return follow(scene, ways, coherence, shares);
    const uint32_t hidden = scene.tracer().occluded({rays.data(), ways.size()}, coherence);
    for (size_t i = 0; i < ways.size(); ++i)
        shares[i] = (hidden >> i & 1u) != 0 ? Color(0.0f) : free_of_volumes(scene, ways[i]->ray, ways[i]->kind);
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
    FreeWay* const alone = &way;
    Color share(0.0f);
    free_shares_of_packet(scene, {&alone, 1}, Coherence::Incoherent, &share);
    return share;
}

}  // namespace rayleaf
