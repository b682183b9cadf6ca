// The closures of participating media.
#pragma once

#include "shading/closures.h"
#include "shading/inputs.h"
#include "shading/operands.h"
#include "shading/operation.h"

namespace rayleaf {

/// Absorption, scattering, and all that the Principled Volume does.
void add_volume_closure(Operation operation, const Operands& operands, const ShadingInputs& inputs, Closures& closures);

}  // namespace rayleaf
