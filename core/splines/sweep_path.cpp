#include "splines/sweep_path.h"

#include "splines/bernstein.h"
#include "splines/sweep_frames.h"

#include <algorithm>

namespace rayleaf {
namespace {

/// The derivative of a segment counts as zero below this share of its control points' distances.
constexpr double kStandstill = 1e-10;
/// Where it is zero, the direction is taken this far inside the segment.
constexpr double kLook = 1e-5;

/// `Basis`: BernsteinBasis, or the one of the segment's degree.
template <typename Basis>
struct SegmentBasis {
    Basis basis;
    const SweepSegment& segment;
    const SweepControl* controls;

    /// Value and two derivatives of the homogeneous sums of `of(control)`.
    template <typename Value, typename Of>
    std::array<Value, 3> sums(const Of& of) const {
        StackBuffer<Value, kStackDegree + 1> values(segment.degree + size_t{1});
        for (int i = 0; i <= segment.degree; ++i) values[i] = of(controls[i]);
        return {basis.value(values.data()), basis.first(values.data()), basis.second(values.data())};
    }
};

/// A bend below this share of the second derivative, or of the segment's size, is rounding: on straight segments whose
/// handles lie on the line, the binormal would be random.
constexpr double kNoBend = 1e-10;

/// The unit direction of the first of the vectors that has one, without z in the plane.
struct Direction {
    Vec3d tangent{0, 0, 0}, change{0, 0, 0};
    bool found = false;
};

Direction direction_of(Vec3d first, Vec3d second, double size, SweepSpace space) {
    if (space == SweepSpace::Planar) first.z = second.z = 0.0;
    Direction result;
    const double length = std::sqrt(first.dot(first));
    if (!(length > kStandstill * size)) return result;
    result.tangent = first / length;
    result.change = (second - result.tangent * result.tangent.dot(second)) / length;
    result.found = true;
    return result;
}

double size_of(const SweepSegment& segment, const SweepControl* controls) {
    const auto position = [&](int i) {
        const Vec4d& p = controls[i].point;
        return segment.rational ? project(p) : spatial_part(p);
    };
    double size = 0.0;
    for (int i = 1; i <= segment.degree; ++i) size = std::max(size, max_abs(position(i) - position(i - 1)));
    return size * segment.degree;
}

struct Derivatives {
    Vec3d position, first, second;
};

template <typename Basis>
Derivatives derivatives(const SegmentBasis<Basis>& basis) {
    const auto p = basis.template sums<Vec4d>([](const SweepControl& control) { return control.point; });
    Derivatives d{spatial_part(p[0]), spatial_part(p[1]), spatial_part(p[2])};
    if (!basis.segment.rational) return d;
    d.position = project(p[0]);
    d.first = (spatial_part(p[1]) - d.position * p[1].w) / p[0].w;
    d.second = (spatial_part(p[2]) - d.first * (2.0 * p[1].w) - d.position * p[2].w) / p[0].w;
    return d;
}

/// `basis_at` makes the basis at a parameter.
template <typename BasisAt>
SegmentPoint point_of(const SweepSegment& segment, const SweepControl* first_control, double t, SweepSpace space,
                      const BasisAt& basis_at) {
    const SegmentBasis basis{basis_at(t), segment, first_control};
    const Derivatives d = derivatives(basis);
    SegmentPoint result;
    result.position = d.position;
    result.first = d.first;
    const auto scalars =
        basis.template sums<Vec3d>([](const SweepControl& c) { return Vec3d(c.radius, c.tilt, c.point.w); });
    result.radius = scalars[0].x;
    result.radius_change = scalars[1].x;
    result.tilt = scalars[0].y;
    result.tilt_change = scalars[1].y;
    if (segment.rational) {
        const double w = scalars[0].z, w1 = scalars[1].z;
        result.radius /= w;
        result.tilt /= w;
        result.radius_change = (result.radius_change - result.radius * w1) / w;
        result.tilt_change = (result.tilt_change - result.tilt * w1) / w;
    }
    const double size = size_of(segment, first_control);
    Direction direction = direction_of(d.first, d.second, size, space);
    if (!direction.found) {
        const double inside = t < 0.5 ? t + kLook : t - kLook;
        const Derivatives near = derivatives(SegmentBasis{basis_at(inside), segment, first_control});
        direction = direction_of(near.first, near.second, size * kStandstill, space);
    }
    if (!direction.found) direction.tangent = space == SweepSpace::Planar ? Vec3d(1, 0, 0) : Vec3d(0, 0, 1);
    result.tangent = direction.tangent;
    if (max_abs(d.second.cross(result.tangent)) > kNoBend * std::max(max_abs(d.second), size)) result.second = d.second;
    result.tangent_change = direction.change;
    return result;
}

}  // namespace

SegmentPoint SweepPath::point(const SweepSegment& segment, double t) const {
    const SweepControl* first = &controls[segment.first_control];
    constexpr int kCubic = 3;
    if (segment.degree == kCubic)
        return point_of(segment, first, t, space, [](double at) { return FixedBernsteinBasis<kCubic>(at); });
    return point_of(segment, first, t, space, [&](double at) { return BernsteinBasis(segment.degree, at); });
}

std::pair<double, double> SweepPath::radius(double at, double at_change, double points, double points_change) const {
    if (taper_use == TaperUse::None) return {points / scale, points_change / scale};
    const SweepTaper::Factor factor = taper->at(at);
    double value = factor.value, change = factor.slope * at_change;
    if (taper_use == TaperUse::Multiply) {
        change = change * points + value * points_change;
        value *= points;
    } else if (taper_use == TaperUse::Add) {
        change += points_change;
        value += points;
    }
    return {value / scale, change / scale};
}

double SweepPath::share(const SweepPiece& piece, double u) const {
    const double t = piece.begin + (piece.end - piece.begin) * u;
    if (piece.kind == SweepPieceKind::Ruled) return t;
    const SweepSegment& segment = segments[piece.source];
    return segment.share_begin + (segment.share_end - segment.share_begin) * t;
}

SweepRingPoint SweepPath::evaluate(const SweepPiece& piece, double u) const {
    SweepRingPoint result;
    if (piece.kind == SweepPieceKind::Ruled) {
        const SweepRing &from = rings[piece.source], &to = rings[piece.source + 1];
        result.change = {to.center - from.center, to.across - from.across, to.up - from.up};
        if (u == 1.0) {
            result.ring = to;
            return result;
        }
        result.ring = {from.center + result.change.center * u, from.across + result.change.across * u,
                       from.up + result.change.up * u};
        return result;
    }
    const double length = piece.end - piece.begin, t = piece.begin + length * u;
    const SweepSegment& segment = segments[piece.source];
    const SegmentPoint at = point(segment, t);
    const double taper_length = double{segment.taper_end} - segment.taper_begin;
    const auto [r, dr] = radius(segment.taper_begin + taper_length * t, taper_length, at.radius, at.radius_change);
    result.ring.center = at.position;
    result.change.center = at.first * length;
    if (space == SweepSpace::Planar) {
        const Vec3d normal(-at.tangent.y, at.tangent.x, 0);
        const Vec3d normal_change(-at.tangent_change.y, at.tangent_change.x, 0);
        result.ring.across = normal * r;
        result.ring.up = Vec3d(0, 0, r);
        result.change.across = (normal * dr + normal_change * r) * length;
        result.change.up = Vec3d(0, 0, dr * length);
        return result;
    }
    const Vec3d begin_tangent(piece.tangent), begin_normal(piece.normal);
    const CarriedNormal carried_normal = carried(begin_tangent, at.tangent, at.tangent_change, begin_normal);
    // The stored frame is in single precision, so its carried normal is made perpendicular once more.
    const Vec3d normal = perpendicular(carried_normal.value, at.tangent), side = at.tangent.cross(normal);
    const Vec3d side_change = at.tangent_change.cross(normal) + at.tangent.cross(carried_normal.change);
    const double turn_length = double{segment.turn_end} - segment.turn_begin;
    const double angle = u * (piece.twist[0] + u * (piece.twist[1] + u * piece.twist[2])) + at.tilt +
                         segment.turn_begin + turn_length * t;
    const double angle_change = (piece.twist[0] + u * (2.0 * piece.twist[1] + u * 3.0 * piece.twist[2])) / length +
                                at.tilt_change + turn_length;
    const double c = std::cos(angle), s = std::sin(angle);
    const Vec3d across = normal * c + side * s, up = side * c - normal * s;
    const Vec3d across_change = carried_normal.change * c + side_change * s + up * angle_change;
    const Vec3d up_change = side_change * c - carried_normal.change * s - across * angle_change;
    result.ring.across = across * r;
    result.ring.up = up * r;
    result.change.across = (across * dr + across_change * r) * length;
    result.change.up = (up * dr + up_change * r) * length;
    return result;
}

const SweepSpline& SweepPath::spline_of(uint32_t piece) const {
    const auto after = std::upper_bound(splines.begin(), splines.end(), piece,
                                        [](uint32_t p, const SweepSpline& spline) { return p < spline.first_piece; });
    return *(after - 1);
}

size_t SweepPath::bytes() const {
    return controls.capacity() * sizeof(SweepControl) + segments.capacity() * sizeof(SweepSegment) +
           pieces.capacity() * sizeof(SweepPiece) + rings.capacity() * sizeof(SweepRing) +
           splines.capacity() * sizeof(SweepSpline);
}

}  // namespace rayleaf
