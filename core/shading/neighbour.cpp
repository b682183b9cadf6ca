#include "shading/neighbour.h"

#include "shading/tangents.h"

namespace rayleaf {
namespace {

/// A 2x2 system may have lost this share of its squared scale before it counts as singular.
constexpr float kSingular = 1e-12f;

/// Numbers x and y for which x * a + y * b comes nearest to `c`; zero where a and b do not span a plane.
template <typename T>
Vec2f least_squares(const Imath::Vec3<T>& a, const Imath::Vec3<T>& b, const Imath::Vec3<T>& c) {
    const T aa = a.length2(), ab = a.dot(b), bb = b.length2(), determinant = aa * bb - ab * ab;
    if (!(determinant > T(kSingular) * aa * bb)) return {0.0f, 0.0f};
    const T ac = a.dot(c), bc = b.dot(c);
    return {static_cast<float>((bb * ac - ab * bc) / determinant),
            static_cast<float>((aa * bc - ab * ac) / determinant)};
}

/// How the place on the shape, object space, changes with the parameters of the primitive that was hit.
struct ParameterJacobian {
    Vec3d by_u{0.0}, by_v{0.0};

    ParameterJacobian() = default;
    explicit ParameterJacobian(const SurfacePoint& point) {
        if (point.shape->kind() == ShapeKind::TriangleMesh) {
            const TriangleCorners corners = triangle_corners(point);
            by_u = corners[1] - corners[0];
            by_v = corners[2] - corners[0];
            return;
        }
        constexpr float kStep = 1.0f / 256;  // in parameters of the primitive
        LocalHit along_u = point.local, along_v = point.local;
        const float step_u = along_u.u > 0.5f ? -kStep : kStep, step_v = along_v.v > 0.5f ? -kStep : kStep;
        along_u.u += step_u;
        along_v.v += step_v;
        const Affine3d map = point.shape->frame().to_object();
        const Vec3d here = point.shape->surface(point.local).position;
        by_u = map.vector(point.shape->surface(along_u).position - here) / double{step_u};
        by_v = map.vector(point.shape->surface(along_v).position - here) / double{step_v};
    }

    /// The hit that is `step` further.
    LocalHit stepped(const SurfacePoint& point, const Vec3d& step) const {
        const Vec2f change = least_squares(by_u, by_v, step);
        LocalHit hit = point.local;
        hit.u += change.x;
        hit.v += change.y;
        if (point.shape->kind() != ShapeKind::TriangleMesh) {  // patches end; triangles extrapolate linearly
            hit.u = std::clamp(hit.u, 0.0f, 1.0f);
            hit.v = std::clamp(hit.v, 0.0f, 1.0f);
        }
        return hit;
    }
};

}  // namespace

Vec2f uv_step(const SurfacePoint& point, const Vec3f& dp) {
    return least_squares(point.dp_du, point.dp_dv, dp);
}

Neighbours::Neighbours(const ShadingInputs& inputs, NeighbourAttributes attributes, float width)
    : inputs_{inputs, inputs} {
    const RayDifferential& d = inputs.differential;
    const Vec3f dp[2] = {d.dp_dx * width, d.dp_dy * width}, dd[2] = {d.dd_dx * width, d.dd_dy * width};
    for (int i = 0; i < 2; ++i) inputs_[i].outgoing = normalized_or(inputs.outgoing - dd[i], inputs.outgoing);
    if (inputs.point == nullptr) return;
    const SurfacePoint& here = *inputs.point;
    const bool exact =
        here.shape != nullptr &&
        (attributes == NeighbourAttributes::Exact ||
         (attributes == NeighbourAttributes::ExactIfDeformed && here.shape->attribute(kRestPlace, here.local)));
    const ParameterJacobian jacobian = exact ? ParameterJacobian(here) : ParameterJacobian();
    const auto in_object = [&](const Vec3d& world) {
        return inputs.instance == nullptr ? world : inputs.world_to_object().vector(world);
    };
    for (int i = 0; i < 2; ++i) {
        SurfacePoint& point = points_[i];
        point = here;
        const Vec2f step = uv_step(here, dp[i]);
        point.position += Vec3d(dp[i]);
        point.uv += here.uv_by_u * step.x + here.uv_by_v * step.y;
        point.normal = normalized_or(here.normal + here.dn_du * step.x + here.dn_dv * step.y, here.normal);
        if (exact) point.local = jacobian.stepped(here, in_object(Vec3d(dp[i])));
        inputs_[i].point = &point;
    }
}

}  // namespace rayleaf
