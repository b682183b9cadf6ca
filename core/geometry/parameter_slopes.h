// How the parameters of an element change with its texture coordinates: what turns derivatives by the one into
// derivatives by the other.
#pragma once

#include "base/vector.h"

#include <cmath>
#include <optional>

namespace rayleaf {

/// As they are, the parameters are the texture coordinates.
struct ParameterSlopes {
    Vec2d by_u{1, 0}, by_v{0, 1};
};

/// From how the texture coordinates change with the two parameters; empty where those changes do not span the plane, or
/// so nearly that nothing finite comes of it.
inline std::optional<ParameterSlopes> parameter_slopes(const Vec2d& uv_du, const Vec2d& uv_dv) {
    const double determinant = uv_du.x * uv_dv.y - uv_dv.x * uv_du.y;
    if (determinant == 0.0) return std::nullopt;
    const ParameterSlopes result{Vec2d(uv_dv.y, -uv_du.y) / determinant, Vec2d(-uv_dv.x, uv_du.x) / determinant};
    if (!std::isfinite(result.by_u.x + result.by_u.y + result.by_v.x + result.by_v.y)) return std::nullopt;
    return result;
}

}  // namespace rayleaf
