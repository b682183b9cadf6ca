// Colours of light by its wavelength or temperature, by the CIE's standard observer of 1931 (2 degrees).
#pragma once

#include "base/vector.h"

namespace rayleaf {

/// Linear Rec. 709 of a spectral colour; black beyond what is visible. Negative channels are 0, the scale is Blender's.
Color wavelength_color(float nanometres);

/// Linear Rec. 709 of a black body, of luminance 1; negative channels are 0. Between 800 and 12000 kelvins, as Cycles
/// has it; beyond these the colour stays.
Color blackbody_color(float kelvins);

}  // namespace rayleaf
