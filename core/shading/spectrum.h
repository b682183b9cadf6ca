// Colours of light by its wavelength or temperature, by the CIE's standard observer of 1931 (2 degrees).
#pragma once

#include "base/vector.h"

#include <span>

namespace rayleaf {

/// Linear Rec. 709 of a spectral colour; black beyond what is visible. Negative channels are 0, the scale is Blender's.
Color wavelength_color(float nanometres);

/// Linear Rec. 709 of a black body, of luminance 1; negative channels are 0. Between 800 and 12000 kelvins, as Cycles
/// has it; beyond these the colour stays.
Color blackbody_color(float kelvins);

/// How strongly the observer's red, green and blue answer to light of a wavelength; over all of them each sums to 1, so
/// that an even spectrum is white.
struct Sensitivity {
    float nanometres;
    Color color;
};
std::span<const Sensitivity> rec709_sensitivities();

}  // namespace rayleaf
