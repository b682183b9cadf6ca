// Operations that add to a point's closures.
#pragma once

#include "shading/closures.h"
#include "shading/inputs.h"
#include "shading/operands.h"
#include "shading/operation.h"

namespace rayleaf {

/// Adds what a closure operation stands for. In the world's program only emission, background and holdout count.
void add_closure(Operation operation, uint8_t variant, const Operands& operands, std::span<const int32_t> ints,
                 const ShadingInputs& inputs, Closures& closures);

/// The normal nearest to `normal`, in the plane of the two, whose mirror direction of `outgoing` clears the facet: a
/// shading normal bent too far would reflect rays into the surface. `facet_normal` is on the viewer's side.
Vec3f clearing_normal(const Vec3f& facet_normal, const Vec3f& outgoing, const Vec3f& normal);

/// The first operand of a closure: its weight.
Color weight_of(const Operands& operands);
/// The operand `i` as the normal of a matte lobe, the surface's own where it is not connected.
Vec3f matte_normal(const Operands& operands, uint32_t i, const ShadingInputs& inputs, Clearing clearing);
/// The same of any other lobe.
Vec3f mirror_normal(const Operands& operands, uint32_t i, const ShadingInputs& inputs, Clearing clearing);
/// Index beyond the surface over that on the viewer's side.
float index_beyond(float ior, const ShadingInputs& inputs);

}  // namespace rayleaf
