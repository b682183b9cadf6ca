// Builds the pieces and rings of one spline: the core of add_splines().
#pragma once

#include "splines/sweep_builder.h"
#include "splines/sweep_elements.h"
#include "splines/sweep_range.h"

#include <array>
#include <optional>
#include <utility>
#include <vector>

namespace rayleaf {

/// Directions that differ by less than this, radians, count as equal: a joint of that angle is never visible.
inline constexpr double kSmoothJoint = 1e-6;
/// The number of places of a piece at which directions are checked.
inline constexpr int kPieceLooks = 6;

/// A ring before tilt, radius and the closing turn are applied.
struct RingFrame {
    Vec3d position{0, 0, 0}, tangent{0, 0, 1}, normal{1, 0, 0};
    double widening = 1;  ///< of the profile's x, in the plane
    double share = 0, taper_share = 0, radius = 1, tilt = 0;
};

/// Carries the frame of the last ring along a spline, and adds pieces and rings to the path.
class SplineBuilder {
  public:
    SplineBuilder(SweepPath& path, const SweepOptions& options, SweepElements elements)
        : path_(path), options_(options), elements_(std::move(elements)) {}

    void build();
    bool closed() const { return elements_.closed; }

  private:
    SweepPath& path_;
    const SweepOptions& options_;
    SweepElements elements_;
    ShareRange range_, taper_range_;
    std::vector<double> splits_;  ///< shares where a piece must end
    Vec3d tangent_{0, 0, 1}, normal_{1, 0, 0};
    RingFrame first_ring_;            ///< where a closed spline ends
    size_t first_segment_ = 0;        ///< of this spline in the path
    size_t most_pieces_ = 0;          ///< of the path, when the current curved segment is divided
    double side_ = 1;                 ///< of the binormal, for tangent twist
    std::optional<RingFrame> last_;   ///< the ring from which a ruled piece continues
    std::optional<uint32_t> stored_;  ///< its index, if it was stored
    std::vector<std::pair<uint32_t, RingFrame>> ring_frames_;

    const SweepSegment& segment(size_t i) const { return elements_.elements[i].segment; }
    bool straight(size_t i) const { return elements_.elements[i].straight; }
    SegmentPoint end_of(size_t i, double t) const;
    /// The second derivative at the end of an element, with the sign it has there.
    Vec3d own_second(size_t i) const { return path_.point(segment(i), 1.0).second; }
    double taper_share(double share) const {
        return (share - taper_range_.begin) / (taper_range_.end - taper_range_.begin);
    }
    bool planar() const { return path_.space == SweepSpace::Planar; }
    bool spreads_twist() const {
        return !planar() && options_.twist == TwistMethod::Minimum && options_.closed_twist == ClosedTwist::Spread;
    }

    struct JointRing {
        Vec3d direction{0, 0, 1};
        double widening = 1;
    };
    JointRing joint_ring(const Vec3d& arrives, const Vec3d& leaves) const;
    std::vector<JointRing> joint_rings(size_t before, size_t after) const;
    bool differ(const RingFrame& a, const RingFrame& b) const;
    void arrive(size_t i);
    void begin_upright_at_last_ring();
    void turn_to_own_side(size_t i);
    void arrive_at_seam();
    void start();
    void add_element(size_t i);
    void add_node(size_t before, size_t after);
    void end();
    void close();
    void spread(double angle);
    void turn_to(const Vec3d& tangent, const Vec3d& second = Vec3d(0.0));
    Vec3d normal_at(const Vec3d& tangent, const Vec3d& second) const;
    Vec3d half_way(const Vec3d& a, const Vec3d& b) const;
    RingFrame ring_here(const SegmentPoint& point, double share) const;
    double radius_of(const RingFrame& frame) const;
    SweepRing ring_of(const RingFrame& frame) const;
    uint32_t store(const RingFrame& frame);
    void ruled_to(const RingFrame& frame);
    void add_curved(size_t i, double begin, double end);
    /// Whether a frame can be carried over a part of a segment, or why not.
    enum class Fit : uint8_t { Whole, Turns, Twists };
    void jump(size_t i, double begin, double end);
    void twist_at_once(SweepPiece piece, const Vec3d& end_tangent, const Vec3d& end_normal);
    void divide(size_t i, double begin, double end, int slow_splits);
    Fit fit(size_t i, SweepPiece& piece, bool& slow, Vec3d& end_tangent, Vec3d& end_normal) const;
    bool keeps_direction(size_t i, const Vec3d& direction) const;
    std::array<Vec3d, kPieceLooks> true_normals(size_t i, const SweepPiece& piece,
                                                const std::array<SegmentPoint, kPieceLooks + 1>& looks) const;
};

}  // namespace rayleaf
