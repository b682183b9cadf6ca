// Arithmetic of Blender's converter nodes. Every function is defined for all finite arguments as Cycles defines it:
// division by zero gives 0, roots and logarithms outside their domain give 0, inverse functions clamp.
#pragma once

#include "base/vector.h"
#include "shading/operands.h"
#include "shading/variants.h"

namespace rayleaf {

float math_value(MathVariant variant, float a, float b, float c);
/// DOT_PRODUCT, DISTANCE and LENGTH give their scalar in all four components. `scale` is also REFRACT's index.
Vec4f vector_math_value(VectorMathVariant variant, const Vec3f& a, const Vec3f& b, const Vec3f& c, float scale);
float clamp_value(ClampVariant variant, float value, float low, float high);
/// operands as in operations.def; `clamped` limits the result to the target range (LINEAR and STEPPED; the smooth
/// variants always stay in it).
float map_range_value(MapRangeVariant variant, const Operands& operands, bool clamped);
/// `v` turned about a unit axis, radians.
Vec3f rotated(const Vec3f& v, const Vec3f& axis, float angle);
/// Vector Rotate: operands as in operations.def.
Vec3f vector_rotate_value(VectorRotateVariant variant, const Operands& operands, bool inverted);

/// Euler angles in Blender's order XYZ (about x first) as the columns of a rotation.
struct EulerRotation {
    Vec3f x, y, z;

    explicit EulerRotation(const Vec3f& euler);
    Vec3f apply(const Vec3f& v) const { return x * v.x + y * v.y + z * v.z; }
    Vec3f apply_inverse(const Vec3f& v) const { return {x.dot(v), y.dot(v), z.dot(v)}; }
};

/// The operation `mapping`.
struct Mapping {
    MappingVariant variant;
    Vec3f location;
    EulerRotation rotation;
    Vec3f scale;

    Vec3f of(const Vec3f& vector) const;
};

}  // namespace rayleaf
