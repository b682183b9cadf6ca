// Probabilities that are whole multiples of 1/16. The numbers that choose lights where the camera looks are stratified:
// sixteen samples have one in each sixteenth of the unit interval. A light whose part of it ends on such a border is
// chosen equally often in all pixels; one whose part ends between two is chosen once more or less, by chance, which is
// noise in the light of smooth lamps. Small probabilities stay as they are, and the largest takes what remains.
#pragma once

#include "base/float4.h"

#include <cmath>

namespace rayleaf {

inline constexpr double kPartsOfChoice = 16.0;

/// A number of parts, rounded; less than half a part stays.
inline double whole_parts(double parts) {
    return parts >= 0.5 ? std::floor(parts + 0.5) : parts;
}

/// Weights of a choice that has `parts` of kPartsOfChoice, so that the shares are whole parts where they can be. The
/// sum stays; what is zero stays so, and alone.
Float4 in_whole_parts(Float4 weights, double parts);

}  // namespace rayleaf
