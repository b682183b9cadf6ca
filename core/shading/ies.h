// The light distribution of a lamp as manufacturers measure it (IES LM-63): intensities over angles.
#pragma once

#include "base/vector.h"

#include <span>

namespace rayleaf {

/// A table is: number of vertical angles, of horizontal ones, two zeros; then the vertical angles and the horizontal
/// ones, radians, ascending; then the intensities, vertical angles fastest; zeros up to a multiple of four. At least
/// two angles each. Horizontal angles begin with 0 and end with a full turn, whose intensities are those of 0 again.
bool is_ies_table(std::span<const float> table);

/// Intensity along `direction`, of any length: -z is where vertical angles begin. Cubic between the angles; none beyond
/// the last vertical angle.
float ies_value(std::span<const float> table, const Vec3f& direction);

}  // namespace rayleaf
