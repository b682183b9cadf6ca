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
Vec3f mapping_value(MappingVariant variant, const Vec3f& vector, const Vec3f& location, const Vec3f& rotation,
                    const Vec3f& scale);

}  // namespace rayleaf
