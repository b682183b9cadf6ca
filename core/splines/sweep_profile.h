// The profile of a sweep: a plane curve of arcs, lines and Bezier segments.
//
// Its parameter v runs from 0 to 1, each part taking the same length of it; whether two parts meet smoothly is told by
// their directions. x and y are those of core/geometry/swept_curve.h.
#pragma once

#include "base/vector.h"
#include "splines/bezier_curve.h"

#include <vector>

namespace rayleaf {

enum class ProfilePartKind : uint8_t { Arc, Line, Bezier };

struct ProfilePart {
    ProfilePartKind kind = ProfilePartKind::Line;
    Vec2d begin{0, 0}, end{0, 0};                   ///< line
    Vec2d center{0, 0};                             ///< arc
    double radius = 0, first_angle = 0, angle = 0;  ///< arc: radians, counter-clockwise
    BezierCurve curve;                              ///< Bezier: x and y count
    double pieces = 1;                              ///< its weight in the texture coordinate
};

/// A point of a profile, with derivatives by the part's own parameter.
struct ProfilePoint {
    Vec2d position{0, 0}, first{0, 0}, second{0, 0};
};

struct SweepProfile {
    std::vector<ProfilePart> parts;
    bool closed = false;

    ProfilePoint evaluate(size_t part, double s) const;
    /// Texture coordinate of a place.
    double share(size_t part, double s) const;
    /// The farthest that a point lies from (0, 0); at least.
    double extent() const;
};

/// Which part and where in it a parameter v lies.
struct ProfilePlace {
    size_t part = 0;
    double s = 0;
};
ProfilePlace profile_place(const SweepProfile& profile, float v);
/// The parameter of a place, rounded so that profile_place() gives the same part again.
float profile_parameter(const SweepProfile& profile, const ProfilePlace& place);

}  // namespace rayleaf
