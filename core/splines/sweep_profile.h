// The profile of a sweep: a plane curve of arcs, lines and Bezier segments.
//
// Its parameter v runs from 0 to 1, and each part has an equal share of it. Whether two parts meet smoothly follows
// from their directions. x and y are those of core/geometry/swept_curve.h.
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
    /// The texture coordinates of a part.
    struct Shares {
        double begin = 0, length = 1;
    };
    Shares shares(size_t part) const;
    /// An upper bound of the distance of points from (0, 0).
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
