// Points of the unit circle.
#pragma once

#include "base/vector.h"

#include <numbers>

namespace rayleaf {

/// The point of the unit circle that is a share of a full turn, in [0, 1], from (1, 0). To 1e-9, as the turns that
/// sampling asks for are made of floats: the sine and cosine of the library take twice as long.
inline Vec2d on_circle(double turns) {
    const double half_turns = 2.0 * turns;
    const int nearest = static_cast<int>(half_turns + 0.5);
    // The series of half the angle from there, which is an eighth of a turn at most.
    const double half = (half_turns - nearest) * (0.5 * std::numbers::pi), square = half * half;
    const double sine =
        half * (1.0 + square * (-1.0 / 6 + square * (1.0 / 120 + square * (-1.0 / 5040 + square * (1.0 / 362880)))));
    const double cosine =
        1.0 + square * (-1.0 / 2 + square * (1.0 / 24 + square * (-1.0 / 720 + square * (1.0 / 40320))));
    const double side = 1.0 - 2.0 * (nearest & 1);
    return {side * (1.0 - 2.0 * sine * sine), side * (2.0 * sine * cosine)};
}
inline Vec2f on_circle(float turns) {
    return Vec2f(on_circle(static_cast<double>(turns)));
}

}  // namespace rayleaf
