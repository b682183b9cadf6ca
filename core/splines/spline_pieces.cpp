#include "splines/bernstein.h"
#include "splines/spline_builder.h"
#include "splines/sweep_frames.h"

#include <limits>

namespace rayleaf {
namespace {

/// Cosine of the largest turn of the tangent along a piece, about 50 degrees: then the cubic of the carried frame has
/// the twist to within kTwistError.
constexpr double kMostTurn = 0.64;
constexpr double kTwistError = 1e-6;
/// If a part of a segment this short still turns too much, it is a jump.
constexpr double kShortest = 0x1p-40;
/// The same for turns of the frame about the tangent: at an inflection of a plane curve, the rounding of its points
/// decides how the frame turns, and on Blender's finest samples it jumps.
constexpr double kShortestTwist = 0x1p-16;
/// A part of a piece where the curve is slower than this share of its maximum is divided further, up to so often.
constexpr double kSlow = 0.05;
constexpr int kMostSlowSplits = 6;
/// Steps of the rotation minimizing frame from one checked place to the next.
constexpr int kSubsteps = 2;

}  // namespace

SegmentPoint SplineBuilder::end_of(size_t i, double t) const {
    SegmentPoint point = path_.point(segment(i), t);
    const Vec3d& bend = elements_.elements[i].bend;
    if (max_abs(bend) > 0.0) point.second = bend;
    return point;
}

/// Whether the whole segment stays within kMostTurn of a direction: its derivative lies in the cone of the legs of its
/// control polygon. So no turn is overlooked, however slow the curve is anywhere.
bool SplineBuilder::keeps_direction(size_t i, const Vec3d& direction) const {
    const SweepSegment& s = segment(i);
    if (s.rational) return false;
    const SweepControl* controls = &path_.controls[s.first_control];
    for (int k = 0; k < s.degree; ++k) {
        const Vec3d leg = spatial_part(controls[k + 1].point) - spatial_part(controls[k].point);
        if (!(leg.dot(direction) >= kMostTurn * leg.length())) return false;
    }
    return true;
}

/// The normals of the twist method at the checked places after the first.
std::array<Vec3d, kPieceLooks> SplineBuilder::true_normals(
    size_t i, const SweepPiece& piece, const std::array<SegmentPoint, kPieceLooks + 1>& looks) const {
    std::array<Vec3d, kPieceLooks> normals;
    Vec3d normal = normal_;
    CurveStation station{looks[0].position, looks[0].tangent};
    for (int k = 1; k <= kPieceLooks; ++k) {
        const Vec3d& tangent = looks[k].tangent;
        if (options_.twist == TwistMethod::ZUp) {
            normal = upright_normal(tangent);
        } else if (options_.twist == TwistMethod::Tangent) {
            const Vec3d along = perpendicular(carried(looks[k - 1].tangent, tangent, normal), tangent);
            normal = normalized_or(tangent.cross(looks[k].second) * side_, along);
        } else {
            for (int step = 1; step <= kSubsteps; ++step) {
                const double s = (k - 1 + static_cast<double>(step) / kSubsteps) / kPieceLooks;
                const SegmentPoint next =
                    step == kSubsteps ? looks[k] : end_of(i, piece.begin + (piece.end - piece.begin) * s);
                const CurveStation there{next.position, next.tangent};
                normal = doubly_reflected(station, there, normal);
                station = there;
            }
        }
        normals[k - 1] = normal;
    }
    return normals;
}

/// Whether the frame can be carried over the piece; then its twist is set.
SplineBuilder::Fit SplineBuilder::fit(size_t i, SweepPiece& piece, bool& slow, Vec3d& end_tangent,
                                      Vec3d& end_normal) const {
    std::array<SegmentPoint, kPieceLooks + 1> looks;
    double fastest = 0.0, slowest = std::numeric_limits<double>::infinity();
    for (int k = 0; k <= kPieceLooks; ++k) {
        looks[k] = end_of(i, piece.begin + (piece.end - piece.begin) * k / kPieceLooks);
        const double speed = max_abs(looks[k].first);
        fastest = std::max(fastest, speed);
        slowest = std::min(slowest, speed);
    }
    looks[0].tangent = tangent_;
    slow = slowest < kSlow * fastest && !keeps_direction(i, tangent_);
    for (int k = 1; k <= kPieceLooks; ++k)
        if (!(looks[k].tangent.dot(tangent_) > kMostTurn)) return Fit::Turns;
    end_tangent = looks[kPieceLooks].tangent;
    if (planar()) {
        end_normal = Vec3d(-end_tangent.y, end_tangent.x, 0);
        return Fit::Whole;
    }
    const std::array<Vec3d, kPieceLooks> normals = true_normals(i, piece, looks);
    end_normal = normals[kPieceLooks - 1];
    const Vec3d begin_tangent(piece.tangent), begin_normal(piece.normal);
    std::array<double, kPieceLooks + 1> angle{};
    for (int k = 1; k <= kPieceLooks; ++k) {
        const Vec3d& tangent = looks[k].tangent;
        angle[k] =
            angle_about(tangent, perpendicular(carried(begin_tangent, tangent, begin_normal), tangent), normals[k - 1]);
        if (std::abs(angle[k] - angle[k - 1]) > 1.0) return Fit::Twists;
    }
    // The cubic through 0 and the angles at 1/3, 2/3 and 1.
    const double a = angle[2], b = angle[4], c = angle[6];
    piece.twist = {static_cast<float>(9.0 * a - 4.5 * b + c), static_cast<float>(-22.5 * a + 18.0 * b - 4.5 * c),
                   static_cast<float>(13.5 * a - 13.5 * b + 4.5 * c)};
    for (const int k : {1, 3, 5}) {
        const double s = static_cast<double>(k) / kPieceLooks;
        const double held = s * (piece.twist[0] + s * (piece.twist[1] + s * piece.twist[2]));
        if (!(std::abs(held - angle[k]) < kTwistError)) return Fit::Twists;
    }
    return Fit::Whole;
}

/// Adds the rings of a sudden change of direction or normal: before, half way, and after.
void SplineBuilder::jump(size_t i, double begin, double end) {
    const SegmentPoint before = end_of(i, begin), after = end_of(i, end);
    const double share = segment(i).share_begin + (segment(i).share_end - segment(i).share_begin) * begin;
    last_ = ring_here(before, share);
    stored_.reset();
    if (after.tangent.dot(tangent_) < kMostTurn) {
        turn_to(half_way(tangent_, after.tangent));
        ruled_to(ring_here(before, share));
    }
    normal_ = normal_at(after.tangent, after.second);
    tangent_ = after.tangent;
    ruled_to(ring_here(before, share));
    last_.reset();
}

/// Adds a piece, before which the frame turns to the normal that it must have at the end.
void SplineBuilder::twist_at_once(SweepPiece piece, const Vec3d& end_tangent, const Vec3d& end_normal) {
    const size_t i = piece.source;
    const double begin = segment(i).share_begin + (segment(i).share_end - segment(i).share_begin) * piece.begin;
    const SegmentPoint point = end_of(i, piece.begin);
    last_ = ring_here(point, begin);
    stored_.reset();
    normal_ = perpendicular(carried(end_tangent, tangent_, end_normal), tangent_);
    ruled_to(ring_here(point, begin));
    last_.reset();
    piece.normal = Vec3f(normal_);
    piece.twist = {};
    path_.pieces.push_back(piece);
    tangent_ = end_tangent;
    normal_ = end_normal;
}

/// Adds the part of a curved segment as one piece, or as two halves.
void SplineBuilder::divide(size_t i, double begin, double end, int slow_splits) {
    SweepPiece piece;
    piece.begin = begin;
    piece.end = end;
    piece.source = static_cast<uint32_t>(i);
    piece.tangent = Vec3f(tangent_);
    piece.normal = Vec3f(normal_);
    bool slow = false;
    Vec3d end_tangent, end_normal;
    const Fit found = fit(i, piece, slow, end_tangent, end_normal);
    if (found == Fit::Turns && end - begin < kShortest) {
        jump(i, begin, end);
        return;
    }
    if (found == Fit::Twists && end - begin < kShortestTwist) {
        twist_at_once(piece, end_tangent, end_normal);
        return;
    }
    const bool fits = found == Fit::Whole;
    const bool too_many = path_.pieces.size() >= most_pieces_;
    if (too_many && !fits) {
        piece.twist = {};
        end_tangent = end_of(i, end).tangent;
        end_normal = perpendicular(carried(tangent_, end_tangent, normal_), end_tangent);
    }
    if (too_many || (fits && (!slow || slow_splits >= kMostSlowSplits))) {
        path_.pieces.push_back(piece);
        tangent_ = end_tangent;
        normal_ = end_normal;
        return;
    }
    const double middle = 0.5 * (begin + end);
    divide(i, begin, middle, slow_splits + (fits ? 1 : 0));
    divide(i, middle, end, slow_splits + (fits ? 1 : 0));
}

}  // namespace rayleaf
