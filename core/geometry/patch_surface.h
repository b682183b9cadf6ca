// A surface of NURBS splines, held as Bezier patches in local space.
//
// Patches are numbered spline by spline, within one first along u, then along v. Control points are in double. Those of
// a spline's patches are one net: patches share the points of the border between them. A border row whose control
// points coincide (the pole of a sphere) is moved to one point that is exact in single precision, so that every
// evaluation gives exactly that point.
//
// The outside is the side of P_v x P_u: Blender's own surfaces are wound that way.
#pragma once

#include "geometry/moments.h"
#include "geometry/shape.h"
#include "splines/limit_normal.h"
#include "splines/nurbs.h"
#include "splines/stack_buffer.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rayleaf {

/// The patches of one spline.
struct SplinePatches {
    int degree_u = 0, degree_v = 0;
    bool rational = false, smooth = true;
    uint32_t material_slot = 0;
    uint32_t first_patch = 0;
    std::vector<SplineSpan> spans_u, spans_v;
    size_t first_point = 0;  ///< into the surface's control points: the net of all patches, u fastest
    size_t stride = 0;       ///< of the net's rows

    uint32_t patch_count() const { return static_cast<uint32_t>(spans_u.size() * spans_v.size()); }
    size_t points_per_patch() const { return (degree_u + size_t{1}) * (degree_v + size_t{1}); }
    /// The patch's first control point, into the surface's.
    size_t corner(uint32_t patch) const {
        return first_point + span_v(patch).first_point * stride + span_u(patch).first_point;
    }
    const SplineSpan& span_u(uint32_t patch) const { return spans_u[(patch - first_patch) % spans_u.size()]; }
    const SplineSpan& span_v(uint32_t patch) const { return spans_v[(patch - first_patch) / spans_u.size()]; }
};

class PatchSurface final : public Shape {
  public:
    using Splines = std::vector<NurbsSpline>;
    /// Splines that Blender draws nothing for are left out. Invalid data throws InputError. `moved`, of a surface that
    /// deforms: the splines at even times of the shutter; `splines` are those in its middle.
    PatchSurface(std::string name, const Splines& splines, const std::vector<Splines>& moved = {});

    uint32_t element_count() const override { return patch_count_; }
    LocalSurface surface(const LocalHit& hit) const override;
    std::optional<Vec4f> attribute(AttributeId, const LocalHit&) const override { return std::nullopt; }
    uint32_t material_slot(const LocalHit& hit) const override { return spline_of(hit.primitive).material_slot; }
    uint32_t element_of(const LocalHit& hit) const override { return hit.primitive; }
    ElementPoint element_point(uint32_t element, const Vec2f& parameters) const override {
        return element_point(patch(element), element, parameters);
    }
    ElementPoint element_point_at(uint32_t element, const Vec2f& parameters, float time) const override;
    void line_points(uint32_t element, float u, std::span<const float> v, PlacedPoint* points) const override;
    std::optional<ContentHash> hash_of_content() const override;
    size_t bytes() const override;

    const std::vector<SplinePatches>& splines() const { return splines_; }
    const SplinePatches& spline_of(uint32_t patch) const;
    /// The surface at one of its steps: itself, where it does not deform.
    const PatchSurface& form(size_t step) const {
        return deforms() ? static_cast<const PatchSurface&>(moments_[step]) : *this;
    }
    /// Of a surface that deforms, a patch's control points at a time, one row after the other.
    void mix_points(uint32_t patch, const SplinePatches& spline, float time, Vec4d* points) const;
    /// Around the control points of a patch, at all times.
    Box3d patch_box(uint32_t patch) const;
    /// In the middle of the shutter's time, local space.
    PatchView patch(uint32_t patch) const { return this->patch(patch, spline_of(patch)); }
    PatchView patch(uint32_t patch, const SplinePatches& spline) const {
        return {spline.degree_u, spline.degree_v, spline.rational, &points_[spline.corner(patch)], spline.stride};
    }
    /// The same point by its owner, on borders within a spline and at poles; all that meet there use the owner's.
    BorderPlace owner_place(const BorderPlace& place) const;
    /// How many hits so far needed a limit normal, by the stage that gave it; Regular is not counted.
    NormalCounters limit_normals() const;

  private:
    std::vector<SplinePatches> splines_;
    std::vector<Vec4d> points_;
    uint32_t patch_count_ = 0;
    Moments moments_;  ///< of a surface that deforms
    mutable std::array<std::atomic<uint64_t>, kNormalStageCount> limit_normals_{};

    /// `extent`: what the frame must hold beside the splines, object space.
    PatchSurface(std::string name, const Splines& splines, const Box3d& extent);
    void add_moments(const Splines& splines, const std::vector<Splines>& moved);
    bool has_elements_of(const PatchSurface& other) const;

    /// A patch at a time of the shutter.
    class PatchAt {
      public:
        PatchAt(const PatchSurface& surface, uint32_t patch, const SplinePatches& spline, float time);
        PatchAt(const PatchAt&) = delete;
        PatchAt& operator=(const PatchAt&) = delete;
        const PatchView& view() const { return view_; }

      private:
        static constexpr size_t kMostOnStack = 36;  // Blender's orders end at 6
        StackBuffer<Vec4d, kMostOnStack> mixed_;
        PatchView view_;
    };

    void add_spline(const NurbsSpline& spline);
    static ElementPoint element_point(const PatchView& view, uint32_t element, const Vec2f& parameters);
    LocalSurface surface(const LocalHit& hit, const SplinePatches& spline, const PatchView& view,
                         const PatchPoint& point, const std::optional<LimitNormal>& known) const;
    /// The normal of the adjacent patch at the nearest border, if the spline is smooth there.
    std::optional<Vec3d> neighbour_normal(const LocalHit& hit) const;
};

/// The largest degree a surface may have in a direction.
inline constexpr int kLargestSurfaceDegree = 15;

}  // namespace rayleaf
