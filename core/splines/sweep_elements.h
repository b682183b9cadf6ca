// The segments of a spline in the order in which Blender runs through them, each curved or straight, before frames.
#pragma once

#include "splines/curve_splines.h"
#include "splines/sweep_path.h"

#include <vector>

namespace rayleaf {

/// A straight element is a segment of degree 1.
struct SweepElement {
    SweepSegment segment;
    bool straight = false;
    /// The direction used by tangent twist if the second derivative passes through zero within the segment, as behind a
    /// vector handle: that of the begin on both sides. Zero: the second derivative is used.
    Vec3d bend{0, 0, 0};
    /// The part of Blender's step between two samples that lies before the element's begin; 0: a sample lies there.
    double step_before = 0;
};

struct SweepElements {
    std::vector<SweepElement> elements;
    bool closed = false;
    bool ends_at_seam = false;  ///< see CurveSplines
    int legs = 0;               ///< of a NURBS spline: legs of its control polygon, which Blender calls its segments
    /// Radius and tilt of the last ring of an open spline: Blender takes those of the point itself.
    double end_radius = 1, end_tilt = 0;
    /// The directions to which the first and last ring of an open NURBS spline are perpendicular: the first and last
    /// leg of its control polygon. Zero: the tangent.
    Vec3d begin_direction{0, 0, 0}, end_direction{0, 0, 0};
};

/// The elements of the spline whose control points are [first, first + count), their controls appended to the path's.
/// Elements without length are left out. `center` is subtracted.
SweepElements sweep_elements(const CurveSplines& splines, size_t first, size_t count, const Vec3d& center,
                             std::vector<SweepControl>& controls);

}  // namespace rayleaf
