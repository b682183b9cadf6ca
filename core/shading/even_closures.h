// Closures that are the same at all points of a material but for the way they face: what most plain materials have.
//
// Such a program is run once when it is made, for both sides of a surface; a point gets a copy that is turned to its
// normal, to the bit what a run gives there.
#pragma once

#include "shading/closures.h"
#include "shading/inputs.h"
#include "shading/operation.h"

#include <cstdint>
#include <functional>
#include <optional>

namespace rayleaf {

class Operands;

/// True for an operation that adds closures which depend, beside its operands, on nothing but the surface's own normal,
/// the side that is seen, and whether a diffuse lobe has scattered before. Constants are read, registers are not.
bool turns_alone(Operation operation, uint8_t variant, const Operands& operands);

struct EvenClosures {
    /// By side (0: the front) and by whether a diffuse lobe has scattered before.
    Closures of[2][2];

    /// From what `run` adds at a point.
    explicit EvenClosures(const std::function<void(const ShadingInputs&, Closures&)>& run);
    /// That of all; empty where they differ in it.
    std::optional<Color> even_emission() const;
    /// `inputs` are of a surface. False where the lobes' normals differ, as some alone must clear the facet.
    bool copy(const ShadingInputs& inputs, Closures& result) const;
};

}  // namespace rayleaf
