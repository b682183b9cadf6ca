// Hair, fur and other thin curves: many strands in one shape.
//
// A round strand is the union of the balls around the points of its axis: closed, with round ends, without a gap at a
// corner, and well defined where it bends more tightly than its radius. Rays meet its boundary, so every ray enters as
// often as it leaves. A ribbon is the band of the strand's width that faces the ray.
//
// Elements are segments, numbered strand by strand. A hit's u is the parameter along the segment. v of a round strand
// is the angle around the axis, of a ribbon the place across it, both from 0 to 1.
#pragma once

#include "base/prefetch.h"
#include "geometry/shape.h"
#include "geometry/strand_curve.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rayleaf {

/// The primitive that is traced for a strand. Round and Ribbon are for pictures; the others are for comparison: a chain
/// of balls, and Embree's own round curve.
enum class StrandForm : uint8_t { Round, Ribbon, Spheres, EmbreeRound };

/// v of a hit on the ball at an end of a segment, which is not part of the wall: lights are not sampled there.
inline constexpr float kStrandEnd = 1.0f;
/// v of a direction around the axis, in [0, 1), and the unit direction of a v; `tangent` is unit.
float wall_angle(const Vec3d& tangent, const Vec3d& around);
Vec3d wall_direction(const Vec3d& tangent, double v);

enum class StrandDomain : uint8_t { Strand, Point };

/// Values of an attribute, one per strand or per point; `channels` (1..4) floats each.
struct StrandAttribute {
    AttributeId id = -1;
    int channels = 0;
    StrandDomain domain = StrandDomain::Strand;
    std::vector<float> values;
};

/// Attributes with information about the strand: their ids, -1 if not wanted. All have one channel.
struct StrandInfoIds {
    AttributeId is_strand = -1;  ///< 1
    AttributeId intercept = -1;  ///< share of the strand's length from its root to here
    AttributeId length = -1;     ///< of the whole strand, object units
    AttributeId thickness = -1;  ///< diameter here, object units
};

/// The data of strands; the spans are read during construction only.
struct StrandArrays {
    std::string name;                         ///< for messages
    std::span<const double> points;           ///< x,y,z each, object space
    std::span<const float> radii;             ///< one a point, object units, not negative
    std::span<const int32_t> offsets;         ///< of each strand's first point, and at the end the number of points
    std::span<const uint8_t> cyclic;          ///< one a strand; empty: none is closed
    std::span<const int32_t> material_slots;  ///< one a strand; empty: slot 0 everywhere
    StrandBasis basis = StrandBasis::CatmullRom;
    StrandForm form = StrandForm::Round;
    int spheres_per_segment = 16;  ///< of the form Spheres
    /// Whether a ray that starts in a strand meets it where it leaves, in forms that are solid. Not so hair, as in
    /// Cycles: its closures (shading/lobe_fibre.h) tell what comes out of a fibre, and roots may lie in one another.
    bool has_inside = true;
    AttributeId active_uv = -1;  ///< the attribute that is the surface's `uv`; the first two channels count
    std::vector<StrandAttribute> attributes;
    StrandInfoIds info;
    /// Of strands that deform, x,y,z and radius of each point at even times of the shutter, time by time; `points` and
    /// `radii` are those in its middle.
    std::span<const double> moved_points = {};
};

class Strands final : public Shape {
  public:
    explicit Strands(StrandArrays arrays);

    uint32_t element_count() const override { return static_cast<uint32_t>(strand_of_segment_.size()); }
    LocalSurface surface(const LocalHit& hit) const override;
    std::optional<Vec4f> attribute(AttributeId id, const LocalHit& hit) const override;
    uint32_t material_slot(const LocalHit& hit) const override;
    uint32_t element_of(const LocalHit& hit) const override { return hit.primitive; }
    ElementPoint element_point(uint32_t element, const Vec2f& parameters) const override {
        return element_point_at(element, parameters, kMiddleTime);
    }
    ElementPoint element_point_at(uint32_t element, const Vec2f& parameters, float time) const override;
    size_t bytes() const override;

    StrandForm form() const { return form_; }
    StrandBasis basis() const { return basis_; }
    bool has_inside() const { return has_inside_; }
    int spheres_per_segment() const { return spheres_per_segment_; }
    uint32_t strand_count() const { return static_cast<uint32_t>(first_segment_.size()) - 1; }
    uint32_t strand_of(uint32_t segment) const { return strand_of_segment_[segment]; }
    bool is_cyclic(uint32_t strand) const { return !cyclic_.empty() && cyclic_[strand] != 0; }
    /// Local space, at a time of the shutter.
    StrandSegment segment(uint32_t segment, float time = kMiddleTime) const;
    /// Where a segment's four points lie, for who asks for it often.
    struct Place {
        enum Ends : uint8_t { kWithin = 0, kFirstTwice = 1, kLastTwice = 2, kClosed = 4 };
        uint32_t first;  ///< point; of which the first one or the last one may count twice
        uint8_t ends;    ///< sum of Ends; kClosed: some lie across the end of a closed strand, and `first` says nothing
    };
    Place place(uint32_t segment) const;
    StrandSegment segment(uint32_t segment, const Place& place, float time = kMiddleTime) const;
    /// Brings its points into the cache, as far as they rest.
    void prefetch(const Place& place) const {
        if ((place.ends & Place::kClosed) == 0 && !deforms())
            prefetch_lines(&points_[place.first], 4 * sizeof(StrandPoint));
    }
    /// The segment before (step -1) or after (+1) one of the same strand, wrapped around on a closed strand; empty at
    /// an end.
    std::optional<uint32_t> neighbour(uint32_t segment, int step) const;

  private:
    std::vector<StrandPoint> points_;  ///< local space, step by step
    std::vector<uint32_t> first_point_, first_segment_, strand_of_segment_;
    std::vector<uint8_t> cyclic_;
    std::vector<uint16_t> material_slots_;
    std::vector<StrandAttribute> attributes_;
    std::vector<float> lengths_;  ///< from a strand's root to the end of each segment; only if wanted
    StrandInfoIds info_;
    StrandBasis basis_;
    StrandForm form_;
    int spheres_per_segment_ = 0;
    bool has_inside_ = true;
    int active_uv_ = -1;  ///< index into attributes_

    std::optional<ContentHash> hash_of_content() const override;
    void set_strands(const StrandArrays& arrays);
    void set_points(const StrandArrays& arrays);
    void set_moved_points(const StrandArrays& arrays);
    void add_point(const StrandPoint& point, size_t index);
    Box3d box_at(float time) const;
    size_t point_count() const { return points_.size() / steps(); }
    std::array<Double4, 4> points_at(const std::array<size_t, 4>& indices, float time) const;
    void set_attributes(std::vector<StrandAttribute> attributes, AttributeId active_uv);
    void measure();
    Vec4f attribute_value(const StrandAttribute& attribute, const LocalHit& hit) const;
    std::optional<Vec4f> info_value(AttributeId id, const LocalHit& hit) const;
    uint32_t point_index(uint32_t strand, int64_t point) const;
    int64_t first_of_segment(uint32_t segment) const;
};

}  // namespace rayleaf
