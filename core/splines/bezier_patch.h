// One rational tensor-product Bezier patch of any degrees, in double precision.
//
// P(u,v) = sum_ij B_i(u) B_j(v) p_ij, over [0,1]². Evaluation order is fixed (u first, then v, from index 0 up), so two
// patches that share a border row of control points bit by bit share every point of that border bit by bit: at u = 0 or
// 1 the inner columns are multiplied by exact zeros.
#pragma once

#include "base/vector.h"
#include "splines/bernstein.h"

#include <utility>
#include <vector>

namespace rayleaf {

/// A point of a patch and its derivatives by u and v, units of the control points.
struct PatchPoint {
    Vec3d position, du, dv, duu, duv, dvv;
};

/// The same before division by the weight: derivatives of (wx,wy,wz,w).
struct HomogeneousPatchPoint {
    Vec4d value, du, dv, duu, duv, dvv;
};

enum class PatchDirection { U, V };

/// A patch that does not own its control points, for evaluation: (degree_v+1) rows of (degree_u+1), u fastest. They may
/// be part of a larger net, whose rows are `stride` points apart.
struct PatchView {
    int degree_u = 0, degree_v = 0;
    bool rational = false;          ///< false: every w is 1 and is ignored
    const Vec4d* points = nullptr;  ///< homogeneous (wx,wy,wz,w), w > 0
    size_t stride;                  ///< at least columns(); not initialized, so that no view goes without

    int columns() const { return degree_u + 1; }
    int rows() const { return degree_v + 1; }
    const Vec4d* row(int j) const { return points + static_cast<size_t>(j) * stride; }
    const Vec4d& point(int i, int j) const { return row(j)[i]; }

    Vec3d position(double u, double v) const;
    PatchPoint evaluate(double u, double v) const;
    /// Derivatives of the homogeneous patch; w is 1 and constant where not rational.
    HomogeneousPatchPoint evaluate_homogeneous(double u, double v) const;
};

/// A patch along a line of constant u: the common part of evaluations. Points have the same bits as by the patch.
class PatchColumn {
  public:
    PatchColumn(const PatchView& patch, double u);
    HomogeneousPatchPoint evaluate_homogeneous(double v) const;
    PatchPoint evaluate(double v) const;

  private:
    using Rows = StackBuffer<Vec4d, kStackDegree + 1>;
    int degree_v_;
    bool rational_;
    Rows value_, first_, second_;
};

/// The quotient rule: P = A/w and its derivatives.
PatchPoint project(const HomogeneousPatchPoint& point);

struct BezierPatch {
    int degree_u = 0, degree_v = 0;
    bool rational = false;      ///< false: every w is 1 and is ignored. One value for a whole spline, else borders
                                ///< between its patches would round differently
    std::vector<Vec4d> points;  ///< homogeneous (wx,wy,wz,w), w > 0; u fastest, (degree_v+1) x (degree_u+1)

    static BezierPatch copy_of(const PatchView& patch);
    PatchView view() const { return {degree_u, degree_v, rational, points.data(), degree_u + size_t{1}}; }
    Vec4d& point(int i, int j) { return points[j * (degree_u + 1) + i]; }
    const Vec4d& point(int i, int j) const { return points[j * (degree_u + 1) + i]; }

    Vec3d position(double u, double v) const { return view().position(u, v); }
    PatchPoint evaluate(double u, double v) const { return view().evaluate(u, v); }

    /// The parts below and above parameter t of a direction, each again over [0,1]²; their common border is bit-equal.
    std::pair<BezierPatch, BezierPatch> split(PatchDirection direction, double t) const;
    /// The part [u_begin,u_end] x [v_begin,v_end] over [0,1]².
    BezierPatch restricted(double u_begin, double u_end, double v_begin, double v_end) const;
    /// The same surface, one degree higher in a direction.
    BezierPatch elevated(PatchDirection direction) const;
};

}  // namespace rayleaf
