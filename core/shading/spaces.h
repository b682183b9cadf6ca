// Vectors taken from one space to another: Vector Transform.
#pragma once

#include "shading/inputs.h"
#include "shading/variants.h"

#include <cstdint>
#include <span>

namespace rayleaf {

/// The operation `transform`, by its integers. Normals come out unit; they stay at right angles to their surface, or go
/// the way of directions, as in Cycles before Blender 4.
Vec3f transform(TransformVariant variant, const ShadingInputs& inputs, std::span<const int32_t> ints, const Vec3f& v);

}  // namespace rayleaf
