// One rational Bezier curve of any degree, in double precision.
#pragma once

#include "base/vector.h"

#include <utility>
#include <vector>

namespace rayleaf {

/// A point of a curve and its derivatives by the parameter.
struct CurvePoint {
    Vec3d position, first, second;
};

/// Evaluated in homogeneous form with the quotient rule: P = A/w, P' = (A' - P w')/w, P'' = (A'' - 2 P' w' - P w'')/w.
struct BezierCurve {
    int degree = 0;
    bool rational = false;      ///< false: every w is 1 and is ignored
    std::vector<Vec4d> points;  ///< homogeneous (wx,wy,wz,w), w > 0; degree + 1 of them

    Vec3d position(double t) const;
    /// The same by de Casteljau's algorithm: slower, and without the basis.
    Vec3d position_by_de_casteljau(double t) const;
    CurvePoint evaluate(double t) const;
    /// The parts [0,t] and [t,1], each again over [0,1]; they share a bit-equal point.
    std::pair<BezierCurve, BezierCurve> split(double t) const;
    /// The part [begin,end] over [0,1].
    BezierCurve restricted(double begin, double end) const;
    BezierCurve elevated() const;
};

}  // namespace rayleaf
