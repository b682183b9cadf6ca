// Curve splines as Blender describes them: Bezier, NURBS or poly, with a radius and a tilt at every control point.
//
// Splines of equal settings are given together, for a curve may have a million of them.
#pragma once

#include "base/vector.h"
#include "splines/nurbs.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rayleaf {

/// The largest degree of a NURBS spline here.
inline constexpr int kLargestCurveDegree = 15;

enum class CurveSplineType : uint8_t { Bezier, Nurbs, Poly };

/// How radius and tilt run between the control points of a Bezier spline: Blender's names. A NURBS spline takes them
/// by its own basis, a poly spline and a straight Bezier segment linearly, whatever is set here.
enum class PointInterpolation : uint8_t { Linear, Cardinal, BSpline, Ease };

struct CurveSplines {
    CurveSplineType type = CurveSplineType::Bezier;
    NurbsDirection nurbs;          ///< order and knots of NURBS; `cyclic` counts for every type
    std::vector<uint32_t> counts;  ///< control points of each spline, one after the other in the arrays below
    /// x, y, z, weight of each control point; object space. Weights count for NURBS only, and are 1 elsewhere. Of a
    /// Bezier spline: the point itself.
    std::vector<Vec4d> points;
    std::vector<Vec3d> handles;        ///< Bezier only: left and right handle of each control point
    std::vector<double> radii, tilts;  ///< by control point; empty: 1 and 0. Tilt in radians
    /// Bezier only, by control point: whether the segment that starts there is straight because both of its handles are
    /// vector handles. Blender draws it as a single piece, as one between points of a poly spline. Empty: none is.
    std::vector<uint8_t> straight;
    PointInterpolation radius_interpolation = PointInterpolation::Linear;
    PointInterpolation tilt_interpolation = PointInterpolation::Linear;
    /// Blender's resolution along the spline. The curve is as smooth with any; it weighs segments against each other
    /// where Blender counts pieces: a curved segment has so many, a straight one has 1.
    int resolution = 12;
    int material_slot = 0;  ///< index into the object's material slots
    bool smooth = true;     ///< false: shaded with the normals of facets
    /// Closed splines: Blender's last sample lies where the spline begins, and not a step before, for it was turned
    /// round. So what a taper does between its end and its begin is done there.
    bool ends_at_seam = false;
    int fill_group = 0;  ///< of closed splines: those of one number are filled together (geometry/swept_curve.h)

    size_t spline_count() const { return counts.size(); }
};

/// What is wrong with the arrays as such: sizes, numbers that are not finite, weights, settings. Splines that Blender
/// draws nothing for are no problem.
std::optional<SplineProblem> find_problem(const CurveSplines& splines);

}  // namespace rayleaf
