// One cubic segment of a strand: an axis and a radius over [0,1], as the control points of a Bezier curve.
#pragma once

#include "base/double4.h"

#include <array>
#include <cstdint>

namespace rayleaf {

/// How the points of a strand define its segments. CatmullRom: one segment from point to point, with the first and last
/// point doubled, as in Blender. BSpline: uniform, three segments fewer than points. Bezier: after the first point,
/// three points a segment (handle, handle, point).
enum class StrandBasis : uint8_t { Linear, CatmullRom, BSpline, Bezier };

/// A point of the axis (x, y, z) and the radius there (w).
using StrandPoint = Vec4d;

struct StrandSegment {
    std::array<StrandPoint, 4> points{StrandPoint(0.0), StrandPoint(0.0), StrandPoint(0.0), StrandPoint(0.0)};

    StrandPoint at(double s) const;
    StrandPoint derivative(double s) const;  ///< by s
    /// Both halves, each again over [0,1]; the point they share has the same bits in both.
    void halve(StrandSegment& left, StrandSegment& right) const;
    /// Part number `index` of 2^level equal ones; neighbours share their point bit by bit.
    StrandSegment part(uint32_t level, uint32_t index) const;
    /// A box that contains every ball of the segment.
    Box3d bounds() const;
};

inline Vec3d axis_point(const StrandPoint& p) {
    return {p.x, p.y, p.z};
}

/// The Bezier form of the segment whose points are p[0] .. p[3] of the basis: for Linear and CatmullRom it runs from
/// p[1] to p[2], for the others p are its four points. Points of the axis that two segments share have the same bits in
/// both. A radius that overshoots below zero becomes zero.
StrandSegment bezier_segment(StrandBasis basis, const std::array<Double4, 4>& p);

}  // namespace rayleaf
