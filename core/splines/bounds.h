// Boxes that contain a patch, and how far a grid of facets may lie from it.
#pragma once

#include "base/vector.h"
#include "splines/bezier_curve.h"
#include "splines/bezier_patch.h"

#include <algorithm>

namespace rayleaf {

/// A box that contains every point of the patch, as evaluated in double precision too: the box of the control points
/// (weights are positive, so the surface lies in their convex hull), widened by the rounding error of an evaluation.
Box3d hull_bounds(const PatchView& patch);
Box3d hull_bounds(const BezierCurve& curve);

/// The smallest float box around a double box: a point inside stays inside when both are rounded.
Box3f outward_float(const Box3d& box);

/// Bounds over a whole patch on the length of its second derivatives by u and v, and on the distance of any two of its
/// points.
struct CurvatureBounds {
    double duu = 0, duv = 0, dvv = 0;  ///< units of the control points per parameter²
    double extent = 0;                 ///< units of the control points

    /// Makes these the bounds of another patch too.
    void raise_to(const CurvatureBounds& other) {
        duu = std::max(duu, other.duu);
        duv = std::max(duv, other.duv);
        dvv = std::max(dvv, other.dvv);
        extent = std::max(extent, other.extent);
    }
};

/// Polynomial patches: the largest second difference of control points, times the factors of the degree (the second
/// derivative is a Bezier patch of those differences). Rational patches P = A/w: with the origin moved to the middle of
/// the control points, P_uu = (A_uu - 2 P_u w_u - P w_uu)/w, each factor bounded by its own control points and |P| by
/// their distance from the origin; the same for the others. Where weights differ by more than kTameWeightRatio the
/// patch is quartered first (up to kMostQuarterings times), since the bound grows with the third power of that ratio
/// (for an eighth of a sphere it is 1.9 times the largest second derivative with 1.2, 6 times with 2).
CurvatureBounds curvature_bounds(const PatchView& patch);
inline constexpr double kTameWeightRatio = 1.2;
inline constexpr int kMostQuarterings = 3;

/// A bound on the distance between a point of the patch and the point of equal parameters on the facets of a uniform
/// grid of `cells_u` x `cells_v` cells whose vertices lie on the patch. Facets are triangles (either diagonal) or
/// bilinear.
///     (|P_uu| hu² + 2 |P_uv| hu hv + |P_vv| hv²) / 8
/// (Filip, Magedson, Markot, "Surface algorithms using bounds on derivatives", CAGD 1986.) So no point of one is
/// further than this from the other.
double facet_distance_bound(const CurvatureBounds& bounds, int cells_u, int cells_v);

}  // namespace rayleaf
