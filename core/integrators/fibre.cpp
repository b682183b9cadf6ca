#include "integrators/fibre.h"

#include "geometry/strands.h"

namespace rayleaf {
namespace {

/// Along what of a ray's direction it lies in a tube around the strand where it was hit: in units of the direction.
double way_through(const StrandSegment& segment, double u, const Vec3d& start, const Vec3d& direction) {
    /// A ray along the strand stays inside until that bends: it is let out after so many radii.
    constexpr double kMostRadii = 16.0;
    const StrandPoint center = segment.at(u);
    const Vec3d axis = normalized_or(axis_point(segment.derivative(u)), Vec3d(0, 0, 1));
    const auto across = [&](const Vec3d& v) { return v - axis * axis.dot(v); };
    const Vec3d from = across(start - axis_point(center)), way = across(direction);
    const double a = way.length2(), b = from.dot(way), c = from.length2() - center.w * center.w;
    const double most = kMostRadii * center.w / direction.length();
    if (!(a > 0.0)) return most;
    return std::clamp((-b + std::sqrt(std::max(b * b - a * c, 0.0))) / a, 0.0, most);
}

}  // namespace

void leave_fibre(const Scene& scene, const SurfacePoint& point, const Closures& closures, Ray& ray) {
    const bool is_round = point.shape != nullptr && point.shape->kind() == ShapeKind::Strands &&
                          static_cast<const Strands*>(point.shape)->form() != StrandForm::Ribbon;
    if (!is_round || ray.direction.dot(Vec3d(point.facet_normal)) >= 0.0 || !closures.has_fibre_lobes()) return;
    const auto& strands = static_cast<const Strands&>(*point.shape);
    const Affine3d to_local = scene.tracer().local_to_world(point.instance, point.time).inverse();
    const double way = way_through(strands.segment(point.local.primitive), point.local.u, to_local.point(ray.origin),
                                   to_local.vector(ray.direction));
    const double beyond = way + point.start_offset;
    ray.origin += ray.direction * beyond;
    ray.t_max = std::max(ray.t_max - beyond, 0.0);
}

}  // namespace rayleaf
