// NURBS as Blender describes them, and their conversion to Bezier form.
//
// Blender stores no knots: they follow from the point count, the order and three flags per direction. The rules here
// are those of Blender 3.4 (knots: BKE_nurb_knot_calc_u/v; validity: BKE_nurb_check_valid_u/v), checked against its own
// tessellation by tests/blender/test_nurbs_oracle.py.
//
// Conversion evaluates the blossom of each span at its two ends, which is knot insertion to full multiplicity (Farin,
// Curves and Surfaces for CAGD, 5th ed., section 8.8), for the whole net, first along u, then along v. Neighbouring
// patches take their common border from one place in the refined net, across cyclic seams too, so it is bit-equal.
#pragma once

#include "base/vector.h"
#include "splines/bezier_curve.h"
#include "splines/bezier_patch.h"
#include "splines/spline_axis.h"

#include <optional>
#include <string>
#include <vector>

namespace rayleaf {

/// Blender's settings of one direction of a NURBS spline.
struct NurbsDirection {
    int order = 4;          ///< degree + 1; Blender's panel offers 2..6, any order from 2 up works here
    bool cyclic = false;    ///< closed: the first order - 1 points are repeated after the last
    bool endpoint = false;  ///< the spline starts at its first and ends at its last point
    bool bezier = false;    ///< inner knots of multiplicity order - 1: the points are Bezier control points
};

/// A surface spline. Not validated on construction.
struct NurbsSurface {
    int count_u = 0, count_v = 0;
    std::vector<Vec4d> points;  ///< x, y, z (not multiplied), weight; object space; u fastest, count_v x count_u
    NurbsDirection u, v;
};

/// A surface spline with the settings that Blender stores with it.
struct NurbsSpline {
    NurbsSurface surface;
    int material_slot = 0;  ///< index into the object's material slots
    bool smooth = true;     ///< false: shaded with the normals of flat facets in Blender's own tessellation
};

struct NurbsCurve {
    std::vector<Vec4d> points;  ///< x, y, z (not multiplied), weight; object space
    NurbsDirection direction;
};

enum class SplineProblemKind {
    BadData,             ///< invalid: not finite, weights that are not positive, sizes that do not agree
    DrawsNothing,        ///< valid in Blender, which draws nothing for it
    DrawsControlPolygon  ///< valid in Blender, which draws the control polygon of such a curve
};

/// Why a spline has no surface, in the words of InputError.
struct SplineProblem {
    SplineProblemKind kind;
    std::string argument, got, wanted;
};

/// Empty if the spline can be converted.
std::optional<SplineProblem> find_problem(const NurbsSurface& surface);
std::optional<SplineProblem> find_problem(const NurbsCurve& curve);

/// The knots that Blender implies: count + order of them, count + 2 order - 1 if cyclic. The spline's domain is
/// [knots[order-1], knots[n]], n = count, or count + order - 1 if cyclic. The direction must be valid.
std::vector<double> implied_knots(int count, const NurbsDirection& direction);
struct KnotDomain {
    double begin = 0, end = 0;
};
KnotDomain knot_domain(int count, const NurbsDirection& direction);

/// A curve as Bezier segments that share their end points.
struct BezierChain {
    SplineAxis axis;
    bool rational = false;
    std::vector<Vec4d> points;  ///< homogeneous; axis.point_count of them

    BezierCurve segment(size_t index) const;
    /// The point at a parameter in [0,1] of the whole curve; outside, the nearest end.
    Vec3d position(double t) const;
};

/// A surface as Bezier patches that share their borders.
struct BezierNet {
    SplineAxis u, v;
    bool rational = false;      ///< false if all weights are equal; w is 1 then
    std::vector<Vec4d> points;  ///< homogeneous; u fastest, v.point_count x u.point_count

    size_t patch_count() const { return u.spans.size() * v.spans.size(); }
    BezierPatch patch(size_t span_u, size_t span_v) const;
    /// The point at parameters in [0,1]² of the whole surface; outside, the nearest border.
    Vec3d position(double u, double v) const;
};

/// The spline must be valid. Spans without length are left out.
BezierNet to_bezier(const NurbsSurface& surface);
BezierChain to_bezier(const NurbsCurve& curve);

}  // namespace rayleaf
