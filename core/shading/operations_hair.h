// Operations that add the closures of hair.
#pragma once

#include "shading/closures.h"
#include "shading/inputs.h"
#include "shading/operands.h"
#include "shading/operation.h"

namespace rayleaf {

/// The operand of hair_facets that says how round the fibre is.
inline constexpr uint32_t kRatioOfHairAxes = 11;

/// Adds what one of hair, hair_fibre and hair_facets stands for.
void add_hair(Operation operation, uint8_t variant, const Operands& operands, const ShadingInputs& inputs,
              Closures& closures);

}  // namespace rayleaf
