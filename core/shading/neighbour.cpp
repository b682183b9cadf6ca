#include "shading/neighbour.h"

namespace rayleaf {
namespace {

/// A 2x2 system may have lost this share of its squared scale before it counts as singular.
constexpr float kSingular = 1e-12f;

/// Parameters of the hit one step away, from how the active texture coordinate changes with them.
LocalHit stepped_hit(const SurfacePoint& point, const Vec2f& uv_change) {
    constexpr float kStep = 1.0f / 256;  // in parameters of the primitive
    const LocalHit& hit = point.local;
    LocalHit along_u = hit, along_v = hit;
    const float step_u = hit.u > 0.5f ? -kStep : kStep, step_v = hit.v > 0.5f ? -kStep : kStep;
    along_u.u += step_u;
    along_v.v += step_v;
    const Vec2f here = point.shape->surface(hit).uv;
    const Vec2f by_u = (point.shape->surface(along_u).uv - here) / step_u;
    const Vec2f by_v = (point.shape->surface(along_v).uv - here) / step_v;
    const float determinant = by_u.x * by_v.y - by_u.y * by_v.x;
    if (!(std::abs(determinant) > kSingular * (by_u.length2() + by_v.length2()))) return hit;
    LocalHit stepped = hit;
    stepped.u += (uv_change.x * by_v.y - uv_change.y * by_v.x) / determinant;
    stepped.v += (by_u.x * uv_change.y - by_u.y * uv_change.x) / determinant;
    if (point.shape->kind() == ShapeKind::PatchSurface) {  // patches end; triangles extrapolate linearly
        stepped.u = std::clamp(stepped.u, 0.0f, 1.0f);
        stepped.v = std::clamp(stepped.v, 0.0f, 1.0f);
    }
    return stepped;
}

}  // namespace

Vec2f uv_step(const SurfacePoint& point, const Vec3f& dp) {
    const float a = point.dp_du.length2(), b = point.dp_du.dot(point.dp_dv), c = point.dp_dv.length2();
    const float determinant = a * c - b * b;
    if (!(determinant > kSingular * a * c)) return {0.0f, 0.0f};
    const float along_u = dp.dot(point.dp_du), along_v = dp.dot(point.dp_dv);
    return {(c * along_u - b * along_v) / determinant, (a * along_v - b * along_u) / determinant};
}

Neighbour::Neighbour(const ShadingInputs& inputs, PixelAxis axis, NeighbourAttributes attributes) : inputs_(inputs) {
    const RayDifferential& d = inputs.differential;
    const Vec3f dp = axis == PixelAxis::X ? d.dp_dx : d.dp_dy;
    const Vec3f dd = axis == PixelAxis::X ? d.dd_dx : d.dd_dy;
    inputs_.outgoing = normalized_or(inputs.outgoing - dd, inputs.outgoing);
    if (inputs.point == nullptr) return;
    point_ = *inputs.point;
    const Vec2f step = uv_step(point_, dp);
    point_.position += Vec3d(dp);
    point_.uv += step;
    point_.normal = normalized_or(point_.normal + point_.dn_du * step.x + point_.dn_dv * step.y, inputs.point->normal);
    if (attributes == NeighbourAttributes::Exact && point_.shape != nullptr)
        point_.local = stepped_hit(*inputs.point, step);
    inputs_.point = &point_;
}

}  // namespace rayleaf
