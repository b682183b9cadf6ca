#include "splines/spline_builder.h"
#include "splines/sweep_frames.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace rayleaf {

/// The direction half way between two; for opposite ones, that of the profile's x.
Vec3d SplineBuilder::half_way(const Vec3d& a, const Vec3d& b) const {
    return (a + b).length() > kSmoothJoint ? normalized_or(a + b, a) : normal_;
}

/// The ring between two directions. In the plane it is widened, except where the path turns straight back: there the
/// profile's x keeps the direction of arrival.
SplineBuilder::JointRing SplineBuilder::joint_ring(const Vec3d& arrives, const Vec3d& leaves) const {
    // Lower bound of the squared cosine of half the angle: below it, a turn cannot be distinguished from a turn
    // straight back in single precision, in which Blender computes it.
    constexpr double kNarrowest = 0x1p-25;
    if (!planar()) return {half_way(arrives, leaves), 1.0};
    const double narrowness = 0.5 * (1.0 + arrives.dot(leaves));
    if (narrowness < kNarrowest) return {{arrives.y, -arrives.x, 0.0}, 1.0};
    return {half_way(arrives, leaves), 1.0 / std::sqrt(narrowness)};
}

/// The rings between one segment and the next: one at a sample of Blender's, or the two of a chord that cuts the corner
/// between two samples.
std::vector<SplineBuilder::JointRing> SplineBuilder::joint_rings(size_t before, size_t after) const {
    const SegmentPoint arriving = end_of(before, 1.0), leaving = end_of(after, 0.0);
    const Vec3d &arrives = arriving.tangent, &leaves = leaving.tangent;
    const double ahead = elements_.elements[after].step_before;
    if (ahead == 0.0 || (leaves - arrives).length() <= kSmoothJoint) return {joint_ring(arrives, leaves)};
    const auto speed = [this](const SegmentPoint& point, size_t i) {
        return point.first.length() / (segment(i).share_end - segment(i).share_begin);
    };
    const Vec3d chord = arrives * (ahead * speed(arriving, before)) + leaves * ((1.0 - ahead) * speed(leaving, after));
    const Vec3d cut = normalized_or(chord, arrives);
    return {joint_ring(arrives, cut), joint_ring(cut, leaves)};
}

bool SplineBuilder::differ(const RingFrame& a, const RingFrame& b) const {
    return (a.tangent - b.tangent).length() + (a.normal - b.normal).length() >= kSmoothJoint || a.tilt != b.tilt ||
           radius_of(a) != radius_of(b);
}

/// Adds the ring at the end of an element, unless it is there already.
void SplineBuilder::arrive(size_t i) {
    if (straight(i)) return;
    last_ = ring_here(end_of(i, 1.0), segment(i).share_end);
    stored_.reset();
}

/// The rings between two segments.
void SplineBuilder::add_node(size_t before, size_t after) {
    const SegmentPoint arriving = end_of(before, 1.0), leaving = end_of(after, 0.0);
    const Vec3d leaves = leaving.tangent, second = straight(after) ? Vec3d(0.0) : leaving.second;
    const double share = segment(before).share_end;
    if (!straight(before) && !straight(after) && arriving.second.dot(leaving.second) < 0.0) side_ = -side_;
    const std::vector<JointRing> joints = joint_rings(before, after);
    arrive(before);
    for (const JointRing& joint : joints) {
        turn_to(joint.direction, second);
        RingFrame ring = ring_here(leaving, share);
        ring.widening = joint.widening;
        ring.position = arriving.position;
        if (straight(before) || differ(*last_, ring)) ruled_to(ring);
        last_ = ring;
    }
    if (straight(after)) return;
    if ((leaves - joints.back().direction).length() > kSmoothJoint) {
        turn_to(leaves, leaving.second);
        ruled_to(ring_here(leaving, share));
    }
    tangent_ = leaves;
    last_.reset();
    stored_.reset();
}

/// Sets an upright frame at the last ring before the first of a closed spline. Blender begins to carry the frame there
/// if it spreads the twist.
void SplineBuilder::begin_upright_at_last_ring() {
    const size_t count = elements_.elements.size();
    tangent_ = straight(count - 1)
                   ? half_way(end_of(count > 1 ? count - 2 : 0, 1.0).tangent, end_of(count - 1, 0.0).tangent)
                   : end_of(count - 1, 1.0).tangent;
    normal_ = upright_normal(tangent_);
}

void SplineBuilder::start() {
    const size_t count = elements_.elements.size();
    const SegmentPoint first = end_of(0, 0.0), last = end_of(count - 1, 1.0);
    JointRing joint{normalized_or(elements_.begin_direction, first.tangent), 1.0};
    if (elements_.closed && !elements_.ends_at_seam) joint = joint_ring(last.tangent, first.tangent);
    if (planar()) {
        joint.direction.z = 0.0;
        joint.direction = normalized_or(joint.direction, first.tangent);
    }
    if (!straight(0) && !straight(count - 1) && first.second.dot(own_second(count - 1)) < 0.0) side_ = -1.0;
    tangent_ = joint.direction;
    normal_ = upright_normal(tangent_);
    if (elements_.closed && spreads_twist()) {
        begin_upright_at_last_ring();
        turn_to(joint.direction, Vec3d(0.0));
    }
    normal_ = normal_at(joint.direction, straight(0) ? Vec3d(0.0) : first.second);
    first_ring_ = ring_here(first, 0.0);
    first_ring_.widening = joint.widening;
    last_ = first_ring_;
    if (straight(0)) return;
    if ((joint.direction - first.tangent).length() > kSmoothJoint) {
        turn_to(first.tangent, first.second);
        ruled_to(ring_here(first, 0.0));
    }
    tangent_ = first.tangent;
    last_.reset();
    stored_.reset();
}

/// With tangent twist, Blender compares the last ring's second derivative with its neighbour before that is reversed:
/// so it keeps the side with which it was computed.
void SplineBuilder::turn_to_own_side(size_t i) {
    if (planar() || options_.twist != TwistMethod::Tangent || straight(i)) return;
    side_ = 1.0;
    normal_ = normal_at(tangent_, own_second(i));
}

void SplineBuilder::end() {
    const size_t last = elements_.elements.size() - 1;
    SegmentPoint point = end_of(last, 1.0);
    arrive(last);
    point.radius = elements_.end_radius;
    point.tilt = elements_.end_tilt;
    Vec3d direction = normalized_or(elements_.end_direction, point.tangent);
    if (planar()) direction = normalized_or(Vec3d(direction.x, direction.y, 0), point.tangent);
    turn_to(direction, straight(last) ? Vec3d(0.0) : point.second);
    turn_to_own_side(last);
    const RingFrame ring = ring_here(point, 1.0);
    if (straight(last) || differ(*last_, ring)) ruled_to(ring);
}

/// Turns each ring by its share of the closing angle. Blender begins with the last ring, and has turned the first one
/// by two rings' shares: nothing in the limit of many rings, but straight elements have one each, whatever the
/// resolution.
void SplineBuilder::spread(double angle) {
    const std::vector<SweepElement>& elements = elements_.elements;
    const bool is_polygon =
        std::all_of(elements.begin(), elements.end(), [](const auto& each) { return each.straight; });
    const double first = is_polygon ? 2.0 / static_cast<double>(elements.size()) : 0.0;
    for (size_t k = first_segment_; k < path_.segments.size(); ++k) {
        SweepSegment& s = path_.segments[k];
        s.turn_begin = static_cast<float>(angle * (first + s.share_begin));
        s.turn_end = static_cast<float>(angle * (first + s.share_end));
    }
    for (auto& [index, frame] : ring_frames_) {
        frame.normal = turned(frame.tangent, frame.normal, angle * (first + frame.share));
        path_.rings[index] = ring_of(frame);
    }
}

/// Adds the ring at the seam of a spline that begins right behind it.
void SplineBuilder::arrive_at_seam() {
    const size_t last = elements_.elements.size() - 1;
    const SegmentPoint point = end_of(last, 1.0);
    const JointRing joint = joint_ring(point.tangent, end_of(0, 0.0).tangent);
    turn_to(joint.direction);
    RingFrame ring = ring_here(point, 1.0);
    ring.widening = joint.widening;
    if (straight(last) || differ(*last_, ring)) ruled_to(ring);
    last_ = ring;
}

/// Closes the spline at the first ring, whose share of the taper is 0.
void SplineBuilder::close() {
    const size_t last = elements_.elements.size() - 1;
    arrive(last);
    if (!straight(last)) {
        turn_to_own_side(last);
        const RingFrame ring = ring_here(end_of(last, 1.0), 1.0);
        if (differ(*last_, ring)) ruled_to(ring);
    }
    if (elements_.ends_at_seam) arrive_at_seam();
    RingFrame ring = first_ring_;
    ring.share = 1.0;
    ring.position = end_of(last, 1.0).position;
    turn_to(ring.tangent);
    const double angle = planar() ? 0.0 : angle_about(tangent_, normal_, ring.normal);
    const bool spreads = spreads_twist() && std::abs(angle) >= kSmoothJoint;
    if (spreads) ring.normal = normal_;
    if ((straight(last) && !elements_.ends_at_seam) || differ(*last_, ring)) ruled_to(ring);
    if (spreads) spread(angle);
}

}  // namespace rayleaf
