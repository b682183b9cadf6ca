// The closures of participating media.
#pragma once

#include "shading/closures.h"
#include "shading/inputs.h"
#include "shading/operands.h"
#include "shading/operation.h"

namespace rayleaf {

/// Absorption, scattering, and all that the Principled Volume does.
/// `variant`: the phase function of `volume_scatter`, a PhaseVariant.
void add_volume_closure(Operation operation, uint8_t variant, const Operands& operands, const ShadingInputs& inputs,
                        Closures& closures);

}  // namespace rayleaf
