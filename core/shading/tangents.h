// Directions on the surface, and what is built on them: tangents, vectors and normals given in tangent space, wires.
#pragma once

#include "shading/inputs.h"
#include "shading/variants.h"

#include <array>
#include <cstdint>
#include <span>

namespace rayleaf {

/// Of the triangle of a mesh that was hit, in object space.
using TriangleCorners = std::array<Vec3d, 3>;
TriangleCorners triangle_corners(const SurfacePoint& point);

/// The operation `tangent`, by its integers.
Vec3f tangent(const ShadingInputs& inputs, std::span<const int32_t> ints);
/// Around an axis through the middle of the object's bounding box, on the surface; unit, world.
Vec3f radial_tangent(const ShadingInputs& inputs, int axis);
/// 1 nearer to an edge of the triangle than half `size`, world units or pixels; else 0.
float wireframe(const ShadingInputs& inputs, float size, bool in_pixels);
/// To object space. Cycles' order: the second component counts along the normal.
Vec3f from_tangent_space(const ShadingInputs& inputs, const Vec3f& v);
/// The operation `normal_map`, by its integers.
Vec3f normal_map(NormalMapVariant variant, const ShadingInputs& inputs, std::span<const int32_t> ints, float strength,
                 const Vec3f& color);

}  // namespace rayleaf
