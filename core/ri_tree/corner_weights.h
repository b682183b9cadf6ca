// Weights that interpolate between the corners of a cell (RI, sections 2.4 and 2.5).
#pragma once

#include "ri_tree/line_space.h"

#include <array>
#include <cstdint>
#include <optional>

namespace rayleaf {

using CornerWeights = std::array<double, kCellCorners>;
using CornerSet = uint16_t;  ///< bit c: corner c
inline constexpr CornerSet kAllCorners = 0xffff;

/// Quadrilinear: bilinear over the slopes within each directional group, then over the intercepts; in product form.
/// `position` is in [0, 1] along each axis.
CornerWeights quadrilinear_weights(const std::array<double, kLineAxes>& position);

/// Linear interpolation from some of the corners: of all weights that reproduce every affine function, those with the
/// least sum of squares. Empty where the corners do not suffice: fewer than five, or all in one hyperplane.
std::optional<CornerWeights> affine_weights(CornerSet usable, const std::array<double, kLineAxes>& position);

}  // namespace rayleaf
