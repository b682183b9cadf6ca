#include "shading/tangents.h"

#include "geometry/triangle_mesh.h"
#include "shading/operations_input.h"

namespace rayleaf {

TriangleCorners triangle_corners(const SurfacePoint& point) {
    const Affine3d map = point.shape->frame().to_object();
    const FacetCorners p = static_cast<const TriangleMesh&>(*point.shape).corners(point.local.primitive);
    return {map.point(p[0]), map.point(p[1]), map.point(p[2])};
}

namespace {

/// Change of the position of a mesh's triangle by the first coordinate of a UV map, in object space; zero where it does
/// not determine one, or of other shapes.
Vec3f along_map(const SurfacePoint& point, int32_t id) {
    if (point.shape == nullptr || point.shape->kind() != ShapeKind::TriangleMesh) return Vec3f(0.0f);
    const TriangleCorners corners = triangle_corners(point);
    Vec2f map[3];
    for (int i = 0; i < 3; ++i) {
        LocalHit hit = point.local;
        hit.u = i == 1 ? 1.0f : 0.0f;
        hit.v = i == 2 ? 1.0f : 0.0f;
        const Vec4f value = point.shape->attribute(id, hit).value_or(spread(0.0f));
        map[i] = Vec2f(value.x, value.y);
    }
    const Vec2f a = map[1] - map[0], b = map[2] - map[0];
    const float determinant = a.x * b.y - a.y * b.x;
    const Vec3f along = Vec3f(corners[1] - corners[0]) * b.y - Vec3f(corners[2] - corners[0]) * a.y;
    return determinant < 0.0f ? -along : along;
}

/// The second of an operation's integers, an attribute.
Vec4f second_attribute(const ShadingInputs& inputs, std::span<const int32_t> ints) {
    return ints.size() > 1 && ints[1] >= 0 ? attribute(inputs, ints[1]) : spread(0.0f);
}

/// The axes a tangent-space vector stands on, unit, on the side of the winding.
struct TangentFrame {
    Vec3f tangent, bitangent, normal;
};

TangentFrame tangent_frame(const Vec3f& normal, const Vec3f& dp_du, const Vec3f& dp_dv) {
    Vec3f fallback_t, fallback_b;
    orthonormal_basis(normal, fallback_t, fallback_b);
    const Vec3f along = dp_du - normal * normal.dot(dp_du);
    const Vec3f t = normalized_or(along, fallback_t);
    Vec3f b = normal.cross(t);
    if (b.dot(dp_dv) < 0.0f) b = -b;  // mirrored UVs
    return {t, b, normal};
}

/// How long the normal is beside tangents that are means of a triangle's corners: as Cycles, which takes the mean of
/// its normals.
float length_of_normal(const SurfacePoint& point) {
    if (point.shape == nullptr || point.shape->kind() != ShapeKind::TriangleMesh) return 1.0f;
    return static_cast<const TriangleMesh&>(*point.shape).normal_length(point.local);
}

/// `v` along a tangent of the object's space, the bitangent on the side given by its w, and the normal; world, not
/// unit.
Vec3f from_known_tangent(const ShadingInputs& inputs, const Vec4f& tangent, const Vec3f& v) {
    const Affine3d out = inputs.object_to_world();
    const Vec3d world(inputs.point->normal);
    const Vec3f unit(normalized_or(Vec3d(out.x.dot(world), out.y.dot(world), out.z.dot(world)), world));
    const Vec3f normal = unit * length_of_normal(*inputs.point);
    const Vec3f along(tangent.x, tangent.y, tangent.z), across = normal.cross(along) * tangent.w;
    return Vec3f(out.outward(Vec3d(along * v.x + across * v.y + normal * v.z)));
}

}  // namespace

Vec3f tangent(const ShadingInputs& inputs, std::span<const int32_t> ints) {
    if (inputs.point == nullptr) return Vec3f(0.0f);
    Vec3f fallback, other;
    orthonormal_basis(facing_normal(inputs), fallback, other);
    const Vec4f known = second_attribute(inputs, ints);
    Vec3f along(known.x, known.y, known.z);
    if (is_black(along) && !ints.empty() && ints[0] >= 0) along = along_map(*inputs.point, ints[0]);
    // Cycles takes tangents into the world as it does normals.
    if (inputs.instance != nullptr) along = Vec3f(inputs.object_to_world().outward(Vec3d(along)));
    return normalized_or(along, normalized_or(inputs.point->dp_du, fallback));
}

Vec3f radial_tangent(const ShadingInputs& inputs, int axis) {
    if (inputs.point == nullptr) return Vec3f(0.0f);
    const Vec3f p = generated(inputs) - Vec3f(0.5f), normal = facing_normal(inputs);
    const Vec3f around[3] = {{0.0f, -p.z, p.y}, {-p.z, 0.0f, p.x}, {-p.y, p.x, 0.0f}};
    Vec3d along(around[axis]);
    if (inputs.instance != nullptr) along = inputs.object_to_world().outward(along);
    Vec3f fallback, other;
    orthonormal_basis(normal, fallback, other);
    const Vec3f world(along);
    return normalized_or(world - normal * normal.dot(world), fallback);
}

float wireframe(const ShadingInputs& inputs, float size, bool in_pixels) {
    if (inputs.point == nullptr || inputs.instance == nullptr || inputs.point->shape == nullptr ||
        inputs.point->shape->kind() != ShapeKind::TriangleMesh)
        return 0.0f;
    const SurfacePoint& point = *inputs.point;
    TriangleCorners corners = triangle_corners(point);
    const Affine3d to_world = inputs.object_to_world();
    for (Vec3d& corner : corners) corner = to_world.point(corner);
    double pixel = 1.0;
    if (in_pixels) {
        const Vec3f out = inputs.outgoing;
        const auto across = [&](const Vec3f& step) { return (step - out * step.dot(out)).length(); };
        pixel = std::max(across(inputs.differential.dp_dx), across(inputs.differential.dp_dy));
    }
    const double half = 0.5 * size * pixel;
    for (size_t i = 0; i < 3; ++i) {
        const Vec3d edge = corners[(i + 1) % 3] - corners[i], from = point.position - corners[i];
        if (edge.cross(from).length2() < half * half * edge.length2()) return 1.0f;
    }
    return 0.0f;
}

Vec3f from_tangent_space(const ShadingInputs& inputs, const Vec3f& v) {
    if (inputs.point == nullptr) return v;
    const auto in_object = [&](const Vec3f& world) {
        return inputs.instance == nullptr ? world : Vec3f(inputs.world_to_object().vector(Vec3d(world)));
    };
    const TangentFrame frame =
        tangent_frame(object_normal(inputs), in_object(inputs.point->dp_du), in_object(inputs.point->dp_dv));
    return frame.tangent * v.x + frame.normal * v.y + frame.bitangent * v.z;
}

Vec3f normal_map(NormalMapVariant variant, const ShadingInputs& inputs, std::span<const int32_t> ints, float strength,
                 const Vec3f& color) {
    if (inputs.point == nullptr) return facing_normal(inputs);
    const Vec3f smooth = inputs.point->normal;
    Vec3f coordinates = color * 2.0f - Vec3f(1.0f);
    const Vec4f known = second_attribute(inputs, ints);
    if (variant == NormalMapVariant::TANGENT && known.w != 0.0f && inputs.instance != nullptr) {
        coordinates = from_known_tangent(inputs, known, coordinates);
    } else if (variant == NormalMapVariant::TANGENT) {
        const TangentFrame frame = tangent_frame(smooth, inputs.point->dp_du, inputs.point->dp_dv);
        coordinates = frame.tangent * coordinates.x + frame.bitangent * coordinates.y + frame.normal * coordinates.z;
    } else if (variant == NormalMapVariant::OBJECT && inputs.instance != nullptr) {
        coordinates = Vec3f(inputs.object_to_world().outward(Vec3d(coordinates)));
    }
    const Vec3f unit = normalized_or(coordinates, smooth);
    const Vec3f mapped = smooth + (unit - smooth) * std::max(strength, 0.0f);
    const Vec3f normal = normalized_or(mapped, smooth);
    return is_backfacing(inputs) ? -normal : normal;
}

}  // namespace rayleaf
