#include "integrators/neighbour_hits.h"

namespace rayleaf {
namespace {

bool take_one_way(const InterpolatedHit& a, const InterpolatedHit& b) {
    return a.way == b.way && a.interior_hits == b.interior_hits && a.total_reflections == b.total_reflections;
}

}  // namespace

NeighbourHits neighbour_hits(const Scene& scene, const Ray& ray, const Hit& hit, const RayDifferential& differential) {
    const Vec3f dp[2] = {differential.dp_dx, differential.dp_dy}, dd[2] = {differential.dd_dx, differential.dd_dy};
    NeighbourHits result;
    for (size_t i = 0; i < 2; ++i) {
        Ray& neighbour = result.rays[i];
        neighbour = ray;
        neighbour.direction = normalized_or(ray.direction + Vec3d(dd[i]), ray.direction);
        neighbour.origin = ray.at(hit.t) + Vec3d(dp[i]) - neighbour.direction * hit.t;
        result.hits[i] = scene.tracer().interpolated_on(hit.instance, neighbour);
        if (result.hits[i] && !take_one_way(result.hits[i]->interpolated, hit.interpolated)) result.hits[i].reset();
    }
    return result;
}

void set_derivatives(const Scene& scene, const NeighbourHits& neighbours, const RayDifferential& differential,
                     SurfacePoint& point) {
    const auto change = [&](size_t i) {
        if (!neighbours.hits[i]) return Vec3f(0.0f);
        return scene.tracer().surface_point(neighbours.rays[i], *neighbours.hits[i]).normal - point.normal;
    };
    point.dp_du = differential.dp_dx;
    point.dp_dv = differential.dp_dy;
    point.dn_du = change(0);
    point.dn_dv = change(1);
}

}  // namespace rayleaf
