#include "splines/bezier_patch.h"

#include "splines/bernstein.h"

namespace rayleaf {

namespace {

using RowBuffer = StackBuffer<Vec4d, kStackDegree + 1>;

/// The part [begin,end] in one direction; see BezierCurve::restricted for the order of the cuts.
BezierPatch restricted_once(const BezierPatch& patch, PatchDirection direction, double begin, double end) {
    if (end >= 1.0 - begin) {
        const BezierPatch low = end < 1.0 ? patch.split(direction, end).first : patch;
        return begin > 0.0 ? low.split(direction, begin / end).second : low;
    }
    const BezierPatch high = begin > 0.0 ? patch.split(direction, begin).second : patch;
    return high.split(direction, (end - begin) / (1.0 - begin)).first;
}

/// The point of a patch whose weights are 1.
PatchPoint plain(const HomogeneousPatchPoint& a) {
    return {spatial_part(a.value), spatial_part(a.du),  spatial_part(a.dv),
            spatial_part(a.duu),   spatial_part(a.duv), spatial_part(a.dvv)};
}

}  // namespace

Vec3d PatchView::position(double u, double v) const {
    const BernsteinBasis basis_u(degree_u, u), basis_v(degree_v, v);
    RowBuffer row(static_cast<size_t>(rows()));
    for (int j = 0; j < rows(); ++j) row[j] = basis_u.value(this->row(j));
    const Vec4d a = basis_v.value(row.data());
    return rational ? rayleaf::project(a) : spatial_part(a);
}

PatchColumn::PatchColumn(const PatchView& patch, double u)
    : degree_v_(patch.degree_v),
      rational_(patch.rational),
      value_(static_cast<size_t>(patch.rows())),
      first_(static_cast<size_t>(patch.rows())),
      second_(static_cast<size_t>(patch.rows())) {
    const BernsteinBasis basis(patch.degree_u, u);
    Vec4d *value = value_.data(), *first = first_.data(), *second = second_.data();
    for (int j = 0; j < patch.rows(); ++j) {
        const Vec4d* row = patch.row(j);
        value[j] = basis.value(row);
        first[j] = basis.first(row);
        second[j] = basis.second(row);
    }
}

HomogeneousPatchPoint PatchColumn::evaluate_homogeneous(double v) const {
    const BernsteinBasis basis(degree_v_, v);
    const Vec4d *value = value_.data(), *first = first_.data(), *second = second_.data();
    return {basis.value(value),  basis.value(first), basis.first(value),
            basis.value(second), basis.first(first), basis.second(value)};
}

PatchPoint PatchColumn::evaluate(double v) const {
    const HomogeneousPatchPoint a = evaluate_homogeneous(v);
    return rational_ ? rayleaf::project(a) : plain(a);
}

namespace {

/// Four numbers, two at a time as every processor computes them.
struct Double4 {
    using Pair = double __attribute__((vector_size(16)));
    Pair xy, zw;

    Double4 operator+(const Double4& b) const { return {xy + b.xy, zw + b.zw}; }
    Double4 operator-(const Double4& b) const { return {xy - b.xy, zw - b.zw}; }
    Double4 operator*(double factor) const { return {xy * factor, zw * factor}; }
    Double4& operator+=(const Double4& b) { return *this = *this + b; }
};

/// PatchColumn's steps for degrees that are compile-time constants.
template <int kDegreeU, int kDegreeV>
HomogeneousPatchPoint evaluate_fixed(const PatchView& patch, double u, double v) {
    const FixedBernsteinBasis<kDegreeU> basis_u(u);
    const FixedBernsteinBasis<kDegreeV> basis_v(v);
    Double4 value[kDegreeV + 1], first[kDegreeV + 1], second[kDegreeV + 1];
    for (int j = 0; j <= kDegreeV; ++j) {
        const Vec4d* points = patch.row(j);
        Double4 row[kDegreeU + 1];
        for (int i = 0; i <= kDegreeU; ++i) {
            const Vec4d& p = points[i];
            row[i] = Double4{Double4::Pair{p.x, p.y}, Double4::Pair{p.z, p.w}};
        }
        value[j] = basis_u.value(row);
        first[j] = basis_u.first(row);
        second[j] = basis_u.second(row);
    }
    const auto vector = [](const Double4& p) { return Vec4d(p.xy[0], p.xy[1], p.zw[0], p.zw[1]); };
    return {vector(basis_v.value(value)),  vector(basis_v.value(first)), vector(basis_v.first(value)),
            vector(basis_v.value(second)), vector(basis_v.first(first)), vector(basis_v.second(value))};
}

}  // namespace

HomogeneousPatchPoint PatchView::evaluate_homogeneous(double u, double v) const {
    if (degree_u == 3 && degree_v == 3) return evaluate_fixed<3, 3>(*this, u, v);
    if (degree_u == 2 && degree_v == 2) return evaluate_fixed<2, 2>(*this, u, v);
    return PatchColumn(*this, u).evaluate_homogeneous(v);
}

PatchPoint PatchView::evaluate(double u, double v) const {
    const HomogeneousPatchPoint a = evaluate_homogeneous(u, v);
    return rational ? rayleaf::project(a) : plain(a);
}

PatchPoint project(const HomogeneousPatchPoint& a) {
    const double w = a.value.w;
    PatchPoint p;
    p.position = project(a.value);
    p.du = (spatial_part(a.du) - p.position * a.du.w) / w;
    p.dv = (spatial_part(a.dv) - p.position * a.dv.w) / w;
    p.duu = (spatial_part(a.duu) - p.du * (2.0 * a.du.w) - p.position * a.duu.w) / w;
    p.duv = (spatial_part(a.duv) - p.du * a.dv.w - p.dv * a.du.w - p.position * a.duv.w) / w;
    p.dvv = (spatial_part(a.dvv) - p.dv * (2.0 * a.dv.w) - p.position * a.dvv.w) / w;
    return p;
}

BezierPatch BezierPatch::copy_of(const PatchView& patch) {
    BezierPatch copy{patch.degree_u, patch.degree_v, patch.rational, {}};
    for (int j = 0; j < patch.rows(); ++j)
        copy.points.insert(copy.points.end(), patch.row(j), patch.row(j) + patch.columns());
    return copy;
}

std::pair<BezierPatch, BezierPatch> BezierPatch::split(PatchDirection direction, double t) const {
    const int columns = degree_u + 1, rows = degree_v + 1;
    BezierPatch low = *this, high = *this;
    if (direction == PatchDirection::U) {
        for (int j = 0; j < rows; ++j) subdivide(degree_u, t, &low.point(0, j), &high.point(0, j));
    } else {
        for (int i = 0; i < columns; ++i) subdivide(degree_v, t, &low.point(i, 0), &high.point(i, 0), columns);
    }
    return {std::move(low), std::move(high)};
}

BezierPatch BezierPatch::restricted(double u_begin, double u_end, double v_begin, double v_end) const {
    return restricted_once(restricted_once(*this, PatchDirection::U, u_begin, u_end), PatchDirection::V, v_begin,
                           v_end);
}

BezierPatch BezierPatch::elevated(PatchDirection direction) const {
    const int columns = degree_u + 1, rows = degree_v + 1;
    const bool along_u = direction == PatchDirection::U;
    BezierPatch out{degree_u + (along_u ? 1 : 0), degree_v + (along_u ? 0 : 1), rational, {}};
    out.points.resize(static_cast<size_t>(out.degree_u + 1) * static_cast<size_t>(out.degree_v + 1));
    if (along_u) {
        for (int j = 0; j < rows; ++j) elevate(degree_u, &point(0, j), 1, &out.point(0, j), 1);
    } else {
        for (int i = 0; i < columns; ++i) elevate(degree_v, &point(i, 0), columns, &out.point(i, 0), columns);
    }
    return out;
}

}  // namespace rayleaf
