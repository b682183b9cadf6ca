// Points of the unit circle.
#pragma once

#include "base/vector.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace rayleaf {

/// The point of the unit circle that is a share of a full turn, from -1/4 to 1, from (1, 0). To 1e-9, as the turns that
/// sampling asks for are made of floats: the sine and cosine of the library take twice as long.
inline Vec2d on_circle(double turns) {
    const double half_turns = 2.0 * turns;
    const int nearest = static_cast<int>(half_turns + 0.5);  // NOLINT(bugprone-incorrect-roundings): from -1/2 on
    // The series of half the angle from there, which is an eighth of a turn at most.
    const double half = (half_turns - nearest) * (0.5 * std::numbers::pi), square = half * half;
    const double sine =
        half * (1.0 + square * (-1.0 / 6 + square * (1.0 / 120 + square * (-1.0 / 5040 + square * (1.0 / 362880)))));
    const double cosine =
        1.0 + square * (-1.0 / 2 + square * (1.0 / 24 + square * (-1.0 / 720 + square * (1.0 / 40320))));
    const double side = 1.0 - 2.0 * (nearest & 1);
    return {side * (1.0 - 2.0 * sine * sine), side * (2.0 * sine * cosine)};
}
/// In single precision, to 1e-7.
inline Vec2f on_circle(float turns) {
    // Added, it leaves the nearest whole number of half turns, the lowest bit of the sum.
    constexpr float kWhole = 0x1.8p23f;
    const float half_turns = 2.0f * turns, shifted = half_turns + kWhole;
    const float half = (half_turns - (shifted - kWhole)) * (0.5f * kPi), square = half * half;
    // Polynomials of least error up to an eighth of a turn.
    const float sine = half * (1.0f + square * (-0.16666651f + square * (0.0083319582f + square * -0.00019493476f)));
    const float cosine = 1.0f + square * (-0.49999893f + square * (0.041656181f + square * -0.0013596585f));
    const uint32_t odd = std::bit_cast<uint32_t>(shifted) << 31;
    const auto turned = [odd](float x) { return std::bit_cast<float>(std::bit_cast<uint32_t>(x) ^ odd); };
    return {turned(1.0f - 2.0f * sine * sine), turned(2.0f * sine * cosine)};
}

/// Which share of a full turn, in [0, 1], leads from (1, 0) to the direction of (x, y): to 2e-8, which is half a turn
/// times the rounding of floats.
inline double turns_of(double x, double y) {
    constexpr double kLeast = 1e-300;
    const double wide = std::abs(x), high = std::abs(y);
    const double slope = std::min(wide, high) / std::max({wide, high, kLeast}), square = slope * slope;
    // A polynomial near the arc tangent up to 1.
    constexpr std::array kFactors = {0.15915492899, -0.05304967440, 0.03178542970, -0.02232850859,
                                     0.01582437398, -0.00953410401, 0.00390836749, -0.00076082727};
    double eighth = 0;
    for (size_t i = kFactors.size(); i-- > 0;) eighth = eighth * square + kFactors[i];
    eighth *= slope;
    const double quarter = high > wide ? 0.25 - eighth : eighth;
    const double half = x < 0.0 ? 0.5 - quarter : quarter;
    return y < 0.0 ? 1.0 - half : half;
}

}  // namespace rayleaf
