#include "splines/bezier_curve.h"

#include "splines/bernstein.h"

namespace rayleaf {

Vec3d BezierCurve::position(double t) const {
    const Vec4d a = BernsteinBasis(degree, t).value(points.data());
    return rational ? project(a) : spatial_part(a);
}

Vec3d BezierCurve::position_by_de_casteljau(double t) const {
    std::vector<Vec4d> between = points;
    const double s = 1.0 - t;
    for (int level = degree; level > 0; --level)
        for (int i = 0; i < level; ++i) between[i] = between[i] * s + between[i + 1] * t;
    return rational ? project(between[0]) : spatial_part(between[0]);
}

CurvePoint BezierCurve::evaluate(double t) const {
    const BernsteinBasis basis(degree, t);
    const Vec4d a = basis.value(points.data()), a1 = basis.first(points.data()), a2 = basis.second(points.data());
    if (!rational) return {spatial_part(a), spatial_part(a1), spatial_part(a2)};
    CurvePoint point;
    point.position = project(a);
    point.first = (spatial_part(a1) - point.position * a1.w) / a.w;
    point.second = (spatial_part(a2) - point.first * (2.0 * a1.w) - point.position * a2.w) / a.w;
    return point;
}

std::pair<BezierCurve, BezierCurve> BezierCurve::split(double t) const {
    BezierCurve left = *this, right = *this;
    subdivide(degree, t, left.points.data(), right.points.data());
    return {std::move(left), std::move(right)};
}

BezierCurve BezierCurve::restricted(double begin, double end) const {
    // Cuts off the shorter part first, so that the second parameter is never a quotient of two small numbers.
    if (end >= 1.0 - begin) {
        const BezierCurve left = end < 1.0 ? split(end).first : *this;
        return begin > 0.0 ? left.split(begin / end).second : left;
    }
    const BezierCurve right = begin > 0.0 ? split(begin).second : *this;
    return right.split((end - begin) / (1.0 - begin)).first;
}

BezierCurve BezierCurve::elevated() const {
    BezierCurve out{degree + 1, rational, std::vector<Vec4d>(points.size() + 1)};
    elevate(degree, points.data(), 1, out.points.data(), 1);
    return out;
}

}  // namespace rayleaf
