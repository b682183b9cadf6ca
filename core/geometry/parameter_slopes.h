// Derivatives of an element's parameters by its texture coordinates: they turn derivatives by the former into
// derivatives by the latter.
#pragma once

#include "base/vector.h"

#include <cmath>
#include <optional>

namespace rayleaf {

/// By default, the parameters are the texture coordinates.
struct ParameterSlopes {
    Vec2d by_u{1, 0}, by_v{0, 1};
};

/// From the derivatives of the texture coordinates by the two parameters; empty if these do not span the plane, or so
/// nearly that the result is not finite.
inline std::optional<ParameterSlopes> parameter_slopes(const Vec2d& uv_du, const Vec2d& uv_dv) {
    const double determinant = uv_du.x * uv_dv.y - uv_dv.x * uv_du.y;
    if (determinant == 0.0) return std::nullopt;
    const ParameterSlopes result{Vec2d(uv_dv.y, -uv_du.y) / determinant, Vec2d(-uv_dv.x, uv_du.x) / determinant};
    if (!std::isfinite(result.by_u.x + result.by_u.y + result.by_v.x + result.by_v.y)) return std::nullopt;
    return result;
}

}  // namespace rayleaf
