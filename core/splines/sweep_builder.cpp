#include "splines/sweep_builder.h"

#include "splines/spline_builder.h"
#include "splines/sweep_frames.h"

#include <algorithm>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {

/// The normal of the twist method for a direction; `second` is the curve's second derivative there.
Vec3d SplineBuilder::normal_at(const Vec3d& tangent, const Vec3d& second) const {
    if (planar()) return Vec3d(-tangent.y, tangent.x, 0);
    if (options_.twist == TwistMethod::ZUp) return upright_normal(tangent);
    const Vec3d along = perpendicular(carried(tangent_, tangent, normal_), tangent);
    if (options_.twist == TwistMethod::Minimum) return along;
    return normalized_or(tangent.cross(second) * side_, along);
}

void SplineBuilder::turn_to(const Vec3d& tangent, const Vec3d& second) {
    normal_ = normal_at(tangent, second);
    tangent_ = tangent;
}

RingFrame SplineBuilder::ring_here(const SegmentPoint& point, double share) const {
    RingFrame frame;
    frame.position = point.position;
    frame.tangent = tangent_;
    frame.normal = normal_;
    frame.share = share;
    frame.taper_share = taper_share(share);
    frame.radius = point.radius;
    frame.tilt = point.tilt;
    return frame;
}

double SplineBuilder::radius_of(const RingFrame& frame) const {
    const RadiusRule rule = path_.radius_rule(frame.taper_share, 0);
    return (rule.factor * frame.radius + rule.added) / path_.scale;
}

SweepRing SplineBuilder::ring_of(const RingFrame& frame) const {
    const double radius = radius_of(frame);
    if (planar()) return {frame.position, frame.normal * (radius * frame.widening), Vec3d(0, 0, radius)};
    const Vec3d across = turned(frame.tangent, frame.normal, frame.tilt);
    return {frame.position, across * radius, frame.tangent.cross(across) * radius};
}

uint32_t SplineBuilder::store(const RingFrame& frame) {
    const auto index = static_cast<uint32_t>(path_.rings.size());
    path_.rings.push_back(ring_of(frame));
    ring_frames_.emplace_back(index, frame);
    return index;
}

/// Adds a ruled piece from the last ring to this one, as far as it lies in the bevel's range.
void SplineBuilder::ruled_to(const RingFrame& frame) {
    const RingFrame from = *last_;
    last_ = frame;
    const bool joint = frame.share == from.share;
    const bool inside = joint ? range_.holds_joint(from.share) : range_.overlaps(from.share, frame.share);
    if (!inside) {
        stored_.reset();
        return;
    }
    // Where the range ends within a straight piece, Blender interpolates centre and tilted frame, and takes the radius
    // of the outer ring. In the plane it interpolates the widened directions.
    const auto between = [&](double share, const RingFrame& outer) {
        RingFrame cut = outer;
        const double s = (share - from.share) / (frame.share - from.share);
        cut.position = from.position + (frame.position - from.position) * s;
        cut.share = share;
        cut.taper_share = taper_share(share);
        if (planar()) {
            const Vec3d across = from.normal * (from.widening * (1.0 - s)) + frame.normal * (frame.widening * s);
            cut.widening = across.length();
            cut.normal = normalized_or(across, from.normal);
            cut.tangent = Vec3d(cut.normal.y, -cut.normal.x, 0);
            return cut;
        }
        const SweepAxes axes = interpolated_axes({from.tangent, turned(from.tangent, from.normal, from.tilt)},
                                                 {frame.tangent, turned(frame.tangent, frame.normal, frame.tilt)}, s);
        cut.tangent = axes.tangent;
        cut.normal = axes.normal;
        cut.tilt = 0;
        return cut;
    };
    SweepPiece piece;
    piece.kind = SweepPieceKind::Ruled;
    piece.begin = std::max(from.share, range_.begin);
    piece.end = std::min(frame.share, range_.end);
    if (piece.begin > from.share) stored_ = store(between(piece.begin, from));
    if (!stored_) stored_ = store(from);
    piece.source = *stored_;
    stored_ = store(piece.end < frame.share ? between(piece.end, frame) : frame);
    path_.pieces.push_back(piece);
}

void SplineBuilder::add_curved(size_t i, double begin, double end) {
    const size_t pieces = path_.pieces.size(), rings = path_.rings.size(), frames = ring_frames_.size();
    constexpr size_t kMostPieces = 4096;  // of one segment: more are only needed by noise
    most_pieces_ = path_.pieces.size() + kMostPieces;
    divide(i, begin, end, 0);
    const SweepSegment& s = segment(i);
    const double middle = s.share_begin + (s.share_end - s.share_begin) * 0.5 * (begin + end);
    if (!range_.overlaps(middle, middle)) {  // outside the range: only the frame is carried on
        path_.pieces.resize(pieces);
        path_.rings.resize(rings);
        ring_frames_.resize(frames);
        return;
    }
    for (size_t k = pieces; k < path_.pieces.size(); ++k)
        if (path_.pieces[k].kind == SweepPieceKind::Curved)
            path_.pieces[k].source = static_cast<uint32_t>(path_.segments.size());
}

void SplineBuilder::add_element(size_t i) {
    if (straight(i)) return;  // its ring at the far end completes it
    const SweepSegment s = segment(i);
    double begin = 0.0;
    for (const double share : splits_) {
        if (!(share > s.share_begin && share < s.share_end)) continue;
        const double t = (share - s.share_begin) / (s.share_end - s.share_begin);
        if (!(t > begin && t < 1.0)) continue;
        add_curved(i, begin, t);
        begin = t;
    }
    add_curved(i, begin, 1.0);
    path_.segments.push_back(s);
    path_.segments.back().taper_begin = static_cast<float>(taper_share(s.share_begin));
    path_.segments.back().taper_end = static_cast<float>(taper_share(s.share_end));
    last_.reset();
    stored_.reset();
}

void SplineBuilder::build() {
    const size_t count = elements_.elements.size();
    if (count == 0) return;
    if (!elements_.closed) range_ = bevel_range(path_, elements_, options_);
    if (count <= 2 && elements_.closed && straight(0) && straight(count - 1)) {  // a spline of two rings is not closed
        elements_.closed = false;
        elements_.elements.resize(1);
        elements_.elements[0].segment.share_end = 1.0;
        elements_.end_radius = end_of(0, 1.0).radius;
        elements_.end_tilt = end_of(0, 1.0).tilt;
    }
    if (!(range_.begin < range_.end)) return;
    splits_ = {range_.begin, range_.end};
    if (options_.taper_fits_bevel) taper_range_ = range_;
    // The last ring of a closed spline has the end of the taper.
    if (elements_.closed && straight(count - 1) && !elements_.ends_at_seam)
        taper_range_.end = segment(count - 1).share_begin;
    for (const double knot : options_.taper_knots)
        splits_.push_back(taper_range_.begin + (taper_range_.end - taper_range_.begin) * knot);
    std::sort(splits_.begin(), splits_.end());
    first_segment_ = path_.segments.size();
    start();
    for (size_t i = 0; i < elements_.elements.size(); ++i) {
        add_element(i);
        if (i + 1 < elements_.elements.size()) add_node(i, i + 1);
    }
    if (elements_.closed)
        close();
    else
        end();
}

namespace {

/// Splines in one task: enough to outweigh its overhead.
constexpr size_t kSplinesAtOnce = 2048;

/// Consecutive splines of a group.
struct SplineRun {
    size_t first_spline, spline_count, first_point;
};

void build_run(SweepPath& path, const CurveSplines& splines, const SplineRun& run, uint32_t group, const Vec3d& center,
               const SweepOptions& options) {
    size_t point = run.first_point;
    for (size_t i = run.first_spline; i < run.first_spline + run.spline_count; ++i) {
        const uint32_t count = splines.counts[i];
        SweepSpline spline;
        spline.first_piece = static_cast<uint32_t>(path.pieces.size());
        spline.group = group;
        spline.capped = !splines.nurbs.cyclic;
        SplineBuilder builder(path, options, sweep_elements(splines, point, count, center, path.controls));
        builder.build();
        spline.piece_count = static_cast<uint32_t>(path.pieces.size()) - spline.first_piece;
        spline.closed = builder.closed();
        if (spline.piece_count > 0) {
            spline.share_begin = path.share(path.pieces[spline.first_piece], 0.0);
            spline.share_length = path.share(path.pieces.back(), 1.0) - spline.share_begin;
            path.splines.push_back(spline);
        }
        point += count;
    }
}

/// Appends the splines of a part to those of the path.
void append(SweepPath& path, const SweepPath& part) {
    const auto controls = static_cast<uint32_t>(path.controls.size());
    const auto segments = static_cast<uint32_t>(path.segments.size()), rings = static_cast<uint32_t>(path.rings.size());
    const auto pieces = static_cast<uint32_t>(path.pieces.size());
    path.controls.insert(path.controls.end(), part.controls.begin(), part.controls.end());
    path.rings.insert(path.rings.end(), part.rings.begin(), part.rings.end());
    for (SweepSegment segment : part.segments) {
        segment.first_control += controls;
        path.segments.push_back(segment);
    }
    for (SweepPiece piece : part.pieces) {
        piece.source += piece.kind == SweepPieceKind::Ruled ? rings : segments;
        path.pieces.push_back(piece);
    }
    for (SweepSpline spline : part.splines) {
        spline.first_piece += pieces;
        path.splines.push_back(spline);
    }
}

}  // namespace

void add_splines(SweepPath& path, const CurveSplines& splines, uint32_t group, const Vec3d& center,
                 const SweepOptions& options) {
    std::vector<SplineRun> runs;
    size_t point = 0;
    for (size_t i = 0; i < splines.counts.size(); ++i) {
        if (i % kSplinesAtOnce == 0) runs.push_back({i, std::min(kSplinesAtOnce, splines.counts.size() - i), point});
        point += splines.counts[i];
    }
    std::vector<SweepPath> parts(runs.size());
    tbb::parallel_for(size_t{0}, runs.size(), [&](size_t i) {
        parts[i].space = path.space;
        parts[i].taper_use = path.taper_use;
        parts[i].taper = path.taper;
        build_run(parts[i], splines, runs[i], group, center, options);
    });
    for (SweepPath& part : parts) {
        append(path, part);
        part = {};
    }
}

void divide_lengths(SweepPath& path, double scale) {
    path.scale *= scale;
    const double factor = 1.0 / scale;
    for (SweepControl& control : path.controls) {
        control.point.x *= factor;
        control.point.y *= factor;
        control.point.z *= factor;
    }
    for (SweepSegment& segment : path.segments) segment.size *= factor;
    for (SweepRing& ring : path.rings) {
        ring.center *= factor;
        ring.across *= factor;
        ring.up *= factor;
    }
}

}  // namespace rayleaf
