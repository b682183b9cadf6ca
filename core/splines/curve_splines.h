// Curve splines as Blender describes them: Bezier, NURBS or poly, with a radius and a tilt at every control point.
//
// Splines with equal settings are given together, because a curve may have a million of them.
#pragma once

#include "base/content_hash.h"
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

/// Interpolation of radius and tilt between the control points of a Bezier spline, by Blender's names. A NURBS spline
/// uses its own basis, a poly spline and a straight Bezier segment are linear, whatever is set here.
enum class PointInterpolation : uint8_t { Linear, Cardinal, BSpline, Ease };

struct CurveSplines {
    CurveSplineType type = CurveSplineType::Bezier;
    NurbsDirection nurbs;          ///< order and knots of NURBS; `cyclic` counts for every type
    std::vector<uint32_t> counts;  ///< control points of each spline, one after the other in the arrays below
    /// x, y, z, weight of each control point; object space. Weights are used for NURBS only, and are 1 elsewhere. For
    /// Bezier splines: the points without handles.
    std::vector<Vec4d> points;
    std::vector<Vec3d> handles;        ///< Bezier only: left and right handle of each control point
    std::vector<double> radii, tilts;  ///< by control point; empty: 1 and 0. Tilt in radians
    /// Bezier only, by control point: whether the segment that starts there is straight because both of its handles are
    /// vector handles. Blender draws it as a single piece, like a segment of a poly spline. Empty: none is.
    std::vector<uint8_t> straight;
    PointInterpolation radius_interpolation = PointInterpolation::Linear;
    PointInterpolation tilt_interpolation = PointInterpolation::Linear;
    /// Blender's resolution along the spline. It does not change how smooth the curve is, only the weight of segments
    /// where Blender counts pieces: a curved segment has this many, a straight one has 1.
    int resolution = 12;
    int material_slot = 0;  ///< index into the object's material slots
    bool smooth = true;     ///< false: shaded with the normals of facets
    /// Closed splines: Blender's last sample lies where the spline begins, not one step before, because the spline was
    /// reversed. So the jump of a taper from its end to its begin is there.
    bool ends_at_seam = false;
    int fill_group = 0;  ///< of closed splines: those of one number are filled together (geometry/swept_curve.h)

    size_t spline_count() const { return counts.size(); }
    void add_to(ContentHasher& hasher) const;
};

/// The first error in the arrays: sizes, numbers that are not finite, weights, settings. Splines that Blender draws
/// nothing for are valid.
std::optional<SplineProblem> find_problem(const CurveSplines& splines);

}  // namespace rayleaf
