// The radius along a spline as the height of another: y over x of a plane curve.
#pragma once

#include "splines/curve_splines.h"
#include "splines/sweep_path.h"

#include <vector>

namespace rayleaf {

/// x is scaled from the curve's first point (share 0) to its last (1). Where the curve turns back, the first of its
/// points is used; beyond its ends, the height of the end.
class CurveTaper final : public SweepTaper {
  public:
    /// The first spline of the group; without one, or without length along x, the factor is 0 everywhere.
    explicit CurveTaper(const CurveSplines& splines);

    Factor at(double share) const override;
    /// Shares inside (0, 1) where two segments meet.
    const std::vector<double>& knots() const { return knots_; }
    /// An upper bound of the absolute factor.
    double largest() const;

  private:
    struct Segment {
        BezierCurve curve;
        double end = 0;      ///< x of its last point
        bool rises = false;  ///< x runs one way all along
    };
    std::vector<Segment> segments_;
    std::vector<double> knots_;
    double begin_ = 0, length_ = 0;

    /// `basis_at` makes the basis at a parameter of the segment.
    template <typename BasisAt>
    Factor factor_at(const Segment& segment, double x, const BasisAt& basis_at) const;
    template <typename BasisAt>
    static double parameter_at(const Segment& segment, double x, double direction, const BasisAt& basis_at);
};

}  // namespace rayleaf
