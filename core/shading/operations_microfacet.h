// Closure operations of microfacets: Glossy, Refraction, Glass, and metals.
#pragma once

#include "shading/closures.h"
#include "shading/inputs.h"
#include "shading/operands.h"
#include "shading/operation.h"
#include "shading/variants.h"

namespace rayleaf {

/// Adds what one of these operations stands for, on a surface.
void add_microfacets(Operation operation, MicrofacetVariant variant, const Operands& operands,
                     std::span<const int32_t> ints, const ShadingInputs& inputs, Closures& closures);

}  // namespace rayleaf
