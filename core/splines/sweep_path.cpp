#include "splines/sweep_path.h"

#include "splines/bernstein.h"
#include "splines/sweep_frames.h"

#include <algorithm>

namespace rayleaf {
namespace {

/// Where it is zero, the direction is taken this far inside the segment.
constexpr double kLook = 1e-5;

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

/// Of a segment: value and derivatives.
struct Derivatives {
    Vec3d position, first, second;
    double radius, radius_change, tilt, tilt_change;
};

template <typename Basis>
Derivatives derivatives(const SweepSegment& segment, const SweepControl* controls, const Basis& basis) {
    const SweepControl a = basis.value(controls), a1 = basis.first(controls);
    const Vec4d a2 = basis.second(controls).point;
    Derivatives d{
        spatial_part(a.point), spatial_part(a1.point), spatial_part(a2), a.radius, a1.radius, a.tilt, a1.tilt};
    if (!segment.rational) return d;
    const double w = a.point.w, w1 = a1.point.w;
    d.position = project(a.point);
    d.first = (d.first - d.position * w1) / w;
    d.second = (d.second - d.first * (2.0 * w1) - d.position * a2.w) / w;
    d.radius /= w;
    d.tilt /= w;
    d.radius_change = (d.radius_change - d.radius * w1) / w;
    d.tilt_change = (d.tilt_change - d.tilt * w1) / w;
    return d;
}

/// `basis_at` makes the basis at a parameter.
template <typename BasisAt>
SegmentPoint point_of(const SweepSegment& segment, const SweepControl* controls, double t, SweepSpace space,
                      const BasisAt& basis_at) {
    const Derivatives d = derivatives(segment, controls, basis_at(t));
    Direction direction = direction_of(d.first, d.second, segment.size, space);
    if (!direction.found) {
        const Derivatives near = derivatives(segment, controls, basis_at(t < 0.5 ? t + kLook : t - kLook));
        direction = direction_of(near.first, near.second, segment.size * kStandstill, space);
    }
    if (!direction.found) direction.tangent = space == SweepSpace::Planar ? Vec3d(1, 0, 0) : Vec3d(0, 0, 1);
    SegmentPoint result{d.position, d.first,         Vec3d(0.0), direction.tangent, direction.change,
                        d.radius,   d.radius_change, d.tilt,     d.tilt_change};
    const double bend = max_abs(d.second.cross(direction.tangent));
    if (bend > kNoBend * std::max(max_abs(d.second), segment.size)) result.second = d.second;
    return result;
}

/// What `use` makes of the basis that fits the segment.
template <typename Use>
auto with_basis(const SweepSegment& segment, const Use& use) {
    constexpr int kCubic = 3;
    if (segment.degree == kCubic) return use([](double at) { return FixedBernsteinBasis<kCubic>(at); });
    return use([&](double at) { return BernsteinBasis(segment.degree, at); });
}

}  // namespace

SegmentPoint SweepPath::point(const SweepSegment& segment, double t) const {
    return with_basis(segment, [&](const auto& basis_at) {
        return point_of(segment, &controls[segment.first_control], t, space, basis_at);
    });
}

RadiusRule SweepPath::radius_rule(double taper_share, double share_change) const {
    if (taper_use == TaperUse::None) return {};
    const SweepTaper::Factor factor = taper->at(taper_share);
    const double change = factor.slope * share_change;
    if (taper_use == TaperUse::Multiply) return {factor.value, change, 0.0, 0.0};
    return {taper_use == TaperUse::Add ? 1.0 : 0.0, 0.0, factor.value, change};
}

double SweepPath::share(const SweepPiece& piece, double u) const {
    const double t = piece.begin + (piece.end - piece.begin) * u;
    if (piece.kind == SweepPieceKind::Ruled) return t;
    const SweepSegment& segment = segments[piece.source];
    return segment.share_begin + (segment.share_end - segment.share_begin) * t;
}

double SweepPath::share_length(const SweepPiece& piece) const {
    const double length = piece.end - piece.begin;
    if (piece.kind == SweepPieceKind::Ruled) return length;
    const SweepSegment& segment = segments[piece.source];
    return (segment.share_end - segment.share_begin) * length;
}

SweepRingPoint SweepPath::evaluate(const SweepPiece& piece, double u) const {
    if (piece.kind == SweepPieceKind::Ruled) {
        SweepRingPoint result;
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
    const CurvedPlace at = place(piece, u);
    return with_basis(*at.segment, [&](const auto& basis_at) { return ring_at(at, basis_at); });
}

CurvedPlace SweepPath::place(const SweepPiece& piece, double u) const {
    CurvedPlace place;
    const SweepSegment& segment = segments[piece.source];
    place.segment = &segment;
    place.controls = &controls[segment.first_control];
    place.length = piece.end - piece.begin;
    place.t = piece.begin + place.length * u;
    place.tangent = Vec3d(piece.tangent);
    place.normal = Vec3d(piece.normal);
    const double turn_length = double{segment.turn_end} - segment.turn_begin;
    place.turn =
        u * (piece.twist[0] + u * (piece.twist[1] + u * piece.twist[2])) + segment.turn_begin + turn_length * place.t;
    place.turn_change =
        (piece.twist[0] + u * (2.0 * piece.twist[1] + u * 3.0 * piece.twist[2])) / place.length + turn_length;
    const double taper_length = double{segment.taper_end} - segment.taper_begin;
    place.radius = radius_rule(segment.taper_begin + taper_length * place.t, taper_length);
    return place;
}

template <typename BasisAt>
SweepRingPoint SweepPath::ring_at(const CurvedPlace& place, const BasisAt& basis_at) const {
    const SegmentPoint at = point_of(*place.segment, place.controls, place.t, space, basis_at);
    const RadiusRule& rule = place.radius;
    const double r = (rule.factor * at.radius + rule.added) / scale;
    const double dr = (rule.factor_change * at.radius + rule.factor * at.radius_change + rule.added_change) / scale;
    const double length = place.length;
    SweepRingPoint result;
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
    const CarriedNormal carried_normal = carried(place.tangent, at.tangent, at.tangent_change, place.normal);
    // The stored frame is in single precision, so its carried normal is made perpendicular once more.
    const Vec3d normal = perpendicular(carried_normal.value, at.tangent), side = at.tangent.cross(normal);
    const Vec3d side_change = at.tangent_change.cross(normal) + at.tangent.cross(carried_normal.change);
    const double angle_change = place.turn_change + at.tilt_change;
    const auto [c, s] = cosine_and_sine(place.turn + at.tilt);
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
