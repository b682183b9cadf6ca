// What a lamp's program makes of its light in the mean.
#pragma once

#include "lights/light.h"

namespace rayleaf {

/// For the choice of a light: a guess from some directions, one world unit away. Never 0, for a narrow beam may lie
/// between them.
double mean_factor(const Lamp& lamp, size_t number, const LampEmission& emission);

}  // namespace rayleaf
