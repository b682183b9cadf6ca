#include "shading/neighbour.h"

namespace rayleaf {
namespace {

/// A 2x2 system may have lost this share of its squared scale before it counts as singular.
constexpr float kSingular = 1e-12f;

/// How the active texture coordinate changes with the parameters of the primitive that was hit.
struct ParameterJacobian {
    Vec2f by_u{0, 0}, by_v{0, 0};
    float determinant = 0;

    ParameterJacobian() = default;  ///< not regular
    explicit ParameterJacobian(const SurfacePoint& point) {
        constexpr float kStep = 1.0f / 256;  // in parameters of the primitive
        LocalHit along_u = point.local, along_v = point.local;
        const float step_u = along_u.u > 0.5f ? -kStep : kStep, step_v = along_v.v > 0.5f ? -kStep : kStep;
        along_u.u += step_u;
        along_v.v += step_v;
        const Vec2f here = point.shape->surface(point.local).uv;
        by_u = (point.shape->surface(along_u).uv - here) / step_u;
        by_v = (point.shape->surface(along_v).uv - here) / step_v;
        determinant = by_u.x * by_v.y - by_u.y * by_v.x;
    }
    bool regular() const { return std::abs(determinant) > kSingular * (by_u.length2() + by_v.length2()); }

    /// The hit whose texture coordinate is `change` further.
    LocalHit stepped(const SurfacePoint& point, const Vec2f& change) const {
        LocalHit hit = point.local;
        hit.u += (change.x * by_v.y - change.y * by_v.x) / determinant;
        hit.v += (by_u.x * change.y - by_u.y * change.x) / determinant;
        if (point.shape->kind() != ShapeKind::TriangleMesh) {  // patches end; triangles extrapolate linearly
            hit.u = std::clamp(hit.u, 0.0f, 1.0f);
            hit.v = std::clamp(hit.v, 0.0f, 1.0f);
        }
        return hit;
    }
};

}  // namespace

Vec2f uv_step(const SurfacePoint& point, const Vec3f& dp) {
    const float a = point.dp_du.length2(), b = point.dp_du.dot(point.dp_dv), c = point.dp_dv.length2();
    const float determinant = a * c - b * b;
    if (!(determinant > kSingular * a * c)) return {0.0f, 0.0f};
    const float along_u = dp.dot(point.dp_du), along_v = dp.dot(point.dp_dv);
    return {(c * along_u - b * along_v) / determinant, (a * along_v - b * along_u) / determinant};
}

Neighbours::Neighbours(const ShadingInputs& inputs, NeighbourAttributes attributes) : inputs_{inputs, inputs} {
    const RayDifferential& d = inputs.differential;
    const Vec3f dp[2] = {d.dp_dx, d.dp_dy}, dd[2] = {d.dd_dx, d.dd_dy};
    for (int i = 0; i < 2; ++i) inputs_[i].outgoing = normalized_or(inputs.outgoing - dd[i], inputs.outgoing);
    if (inputs.point == nullptr) return;
    const SurfacePoint& here = *inputs.point;
    const bool exact = attributes == NeighbourAttributes::Exact && here.shape != nullptr;
    const ParameterJacobian jacobian = exact ? ParameterJacobian(here) : ParameterJacobian();
    for (int i = 0; i < 2; ++i) {
        SurfacePoint& point = points_[i];
        point = here;
        const Vec2f step = uv_step(here, dp[i]);
        point.position += Vec3d(dp[i]);
        point.uv += here.uv_by_u * step.x + here.uv_by_v * step.y;
        point.normal = normalized_or(here.normal + here.dn_du * step.x + here.dn_dv * step.y, here.normal);
        if (jacobian.regular()) point.local = jacobian.stepped(here, step);
        inputs_[i].point = &point;
    }
}

}  // namespace rayleaf
