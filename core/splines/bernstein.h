// The Bernstein basis and de Casteljau's algorithm, for any degree.
//
// B_i^n(t) = C(n,i) (1-t)^(n-i) t^i, i = 0..n, on t in [0,1]. Values come from the triangular recurrence, which adds
// only non-negative terms on [0,1], so it stays accurate at every degree; derivatives are taken of the control points
// (differences) rather than of the basis, so that coincident control points give exactly zero. Degree n has n+1 control
// points. Up to degree kStackDegree nothing is allocated. (Farin, Curves and Surfaces for CAGD, 5th ed., chapters 4-6.)
#pragma once

#include "base/vector.h"
#include "splines/stack_buffer.h"

#include <algorithm>
#include <vector>

namespace rayleaf {

/// The largest degree that is evaluated without touching the heap. Blender's own splines have degree 5 at most.
inline constexpr int kStackDegree = 15;

/// Writes B_0^n(t) .. B_n^n(t) to `values` (degree + 1 numbers). Replacing t by 1-t, if both are exact, reverses the
/// values bit by bit.
void bernstein_values(int degree, double t, double* values);

/// The basis at a parameter for values and two derivatives: degrees n, n-1 and n-2. Lower ones are empty below degree 1
/// and 2.
class BernsteinBasis {
  public:
    BernsteinBasis(int degree, double t);
    int degree() const { return degree_; }

    /// The curve of control points p[0], p[stride], ... and its derivatives by t.
    template <typename Point>
    Point value(const Point* points, int stride = 1) const;
    template <typename Point>
    Point first(const Point* points, int stride = 1) const;
    template <typename Point>
    Point second(const Point* points, int stride = 1) const;

  private:
    int degree_;
    StackBuffer<double, 3 * (kStackDegree + 1)> values_;
};

/// The same for a degree that is a compile-time constant: the same steps, so the same bits.
template <int kDegree>
class FixedBernsteinBasis {
  public:
    explicit FixedBernsteinBasis(double t) {
        value_[0] = 1.0;
        const double s = 1.0 - t;
        for (int k = 0; k < kDegree; ++k) {
            if (k == kDegree - 2) std::copy_n(value_, k + 1, second_);
            if (k == kDegree - 1) std::copy_n(value_, k + 1, first_);
            value_[k + 1] = value_[k] * t;
            for (int i = k; i > 0; --i) value_[i] = value_[i] * s + value_[i - 1] * t;
            value_[0] *= s;
        }
    }
    template <typename Point>
    Point value(const Point* points) const {
        Point sum = points[0] * value_[0];
        for (int i = 1; i <= kDegree; ++i) sum += points[i] * value_[i];
        return sum;
    }
    template <typename Point>
    Point first(const Point* points) const {
        Point sum = points[0] * 0.0;
        for (int i = 0; i < kDegree; ++i) sum += (points[i + 1] - points[i]) * first_[i];
        return sum * static_cast<double>(kDegree);
    }
    template <typename Point>
    Point second(const Point* points) const {
        Point sum = points[0] * 0.0;
        for (int i = 0; i + 1 < kDegree; ++i)
            sum += ((points[i + 2] - points[i + 1]) - (points[i + 1] - points[i])) * second_[i];
        return sum * static_cast<double>(kDegree * (kDegree - 1));
    }

  private:
    double value_[kDegree + 1] = {}, first_[kDegree] = {}, second_[kDegree > 1 ? kDegree - 1 : 1] = {};
};

/// Splits the curve of `points` (degree + 1 of them, `stride` apart) at t by de Casteljau's algorithm, in place:
/// `points` becomes the part [0,t], `right` (same stride) the part [t,1]. The shared point is bit-equal.
void subdivide(int degree, double t, Vec4d* points, Vec4d* right, int stride = 1);

/// Writes the degree + 2 control points of the same curve, one degree higher.
void elevate(int degree, const Vec4d* points, int stride, Vec4d* elevated, int elevated_stride);

/// The point (x,y,z) of a homogeneous (wx,wy,wz,w); w must not be zero.
inline Vec3d project(const Vec4d& point) {
    return {point.x / point.w, point.y / point.w, point.z / point.w};
}
inline Vec3d spatial_part(const Vec4d& point) {
    return {point.x, point.y, point.z};
}
/// A point with weight as homogeneous coordinates.
inline Vec4d homogeneous(const Vec3d& point, double weight) {
    return {point.x * weight, point.y * weight, point.z * weight, weight};
}

template <typename Point>
Point BernsteinBasis::value(const Point* points, int stride) const {
    const double* basis = values_.data();
    Point sum = points[0] * basis[0];
    for (int i = 1; i <= degree_; ++i) sum += points[i * stride] * basis[i];
    return sum;
}

template <typename Point>
Point BernsteinBasis::first(const Point* points, int stride) const {
    const double* basis = values_.data() + degree_ + 1;
    Point sum = points[0] * 0.0;
    for (int i = 0; i < degree_; ++i) sum += (points[(i + 1) * stride] - points[i * stride]) * basis[i];
    return sum * static_cast<double>(degree_);
}

template <typename Point>
Point BernsteinBasis::second(const Point* points, int stride) const {
    const double* basis = values_.data() + 2 * degree_ + 1;
    Point sum = points[0] * 0.0;
    for (int i = 0; i + 1 < degree_; ++i) {
        const Point* p = points + i * stride;
        sum += ((p[2 * stride] - p[stride]) - (p[stride] - p[0])) * basis[i];
    }
    return sum * static_cast<double>(degree_ * (degree_ - 1));
}

}  // namespace rayleaf
