// A sky that a table tells, and the disc of the sun in it: Sky Texture by the models that the add-on computes
// (export/atmosphere.py, export/spectral_atmosphere.py).
#pragma once

#include "base/vector.h"

#include <optional>
#include <span>

namespace rayleaf {

/// Where a world is far brighter than around.
struct SunDisc {
    Vec3d direction{0, 0, 1};  ///< unit, of its middle
    double half_angle = 0;     ///< radians

    bool contains(const Vec3d& unit) const {
        const double chord = 2.0 * std::sin(0.5 * half_angle);
        return (unit - direction).length2() < chord * chord;
    }
    double solid_angle() const {
        const double half_sine = std::sin(0.5 * half_angle);
        return 4.0 * std::numbers::pi * half_sine * half_sine;
    }
};

/// A table is, in fours:
///   direction of the sun, unit; half of the angle that its disc takes, radians, 0 where there is none
///   radiance of the disc at its lower edge; elevation of that edge, radians
///   radiance at its upper edge; elevation of that edge
///   azimuth at which the table begins, radians from y towards x; width, height; 0
///   0: the table is of the half above the horizon, 1: of the whole sphere; elevation below which the disc is not seen;
///   two zeros
/// then the radiance of the sky: rgb by rows from the lowest up, by azimuth; zeros up to a multiple of four. Row i of n
/// above the horizon has its middle where the root of the elevation, in quarters of a turn, is (i + 1/2) / n. A whole
/// table has as many rows below it, mirrored.
bool is_sky_table(std::span<const float> table);

/// The radiance from a direction of any length: between the table's places linearly. Below the horizon, the lowest row
/// of half a table fades to black. The disc is darker towards its edge; it covers the sky of half a table, and adds to
/// that of a whole one, as in Cycles.
Vec3f sky_value(std::span<const float> table, const Vec3f& direction);

/// The disc of a table; empty where there is none.
std::optional<SunDisc> sun_of_sky(std::span<const float> table);

}  // namespace rayleaf
