// A patch surface or subdivision surface whose points are moved: what a material's displacement makes of it.
//
// Elements and their parameters are those of the surface below. A point is moved by what is computed at its place on
// that surface: its position, normal, texture coordinates and attributes. Where elements meet these may differ, so
// every border has one owner, whose place counts for all (`owner_place` of the surfaces).
#pragma once

#include "base/cancel.h"
#include "geometry/shape.h"

#include <memory>
#include <span>

namespace rayleaf {

class Displacement {
  public:
    virtual ~Displacement() = default;
    /// How far a point moves, object space. `surface` is the undisplaced surface at `hit`, its normal on the outside.
    /// Pure; NaN and infinity are found by who asks.
    virtual Vec3d offset(const Shape& base, const LocalHit& hit, const LocalSurface& surface) const = 0;
};

class DisplacedSurface final : public Shape {
  public:
    static bool can_displace(const Shape& base) {
        return base.kind() == ShapeKind::PatchSurface || base.kind() == ShapeKind::SubdivisionSurface;
    }
    /// Throws InputError where a displacement is not finite, and Cancelled soon after `cancel` says so.
    DisplacedSurface(std::shared_ptr<const Shape> base, std::shared_ptr<const Displacement> displacement,
                     const CancelToken& cancel = kNeverCancelled);

    uint32_t element_count() const override { return base_->element_count(); }
    LocalSurface surface(const LocalHit& hit) const override;
    std::optional<Vec4f> attribute(AttributeId id, const LocalHit& hit) const override {
        return base_->attribute(id, hit);
    }
    uint32_t material_slot(const LocalHit& hit) const override { return base_->material_slot(hit); }
    uint32_t element_of(const LocalHit& hit) const override { return base_->element_of(hit); }
    ElementPoint element_point(uint32_t element, const Vec2f& parameters) const override;
    size_t bytes() const override { return sizeof(*this) + base_->bytes(); }

    const Shape& base() const { return *base_; }
    /// The displaced point, local space, the same for all elements that meet there. Throws InputError where it is not
    /// finite, or far from where samples said.
    Vec3d position(uint32_t element, const Vec2f& parameters) const;
    /// The same of points along a line of constant u, none on a border of the element: many at a time cost less.
    void line_positions(uint32_t element, float u, std::span<const float> v, Vec3d* positions) const;

  private:
    /// A displaced point as its element has it.
    struct Moved {
        Vec3d position{0, 0, 0};  ///< local space
        LocalSurface base;        ///< the point below
        bool finite = true;       ///< else it has not been moved
    };
    /// A displaced point and how it changes with the element's parameters: not, beside points that are not finite.
    struct Slopes {
        Moved here;
        Vec3d du{0, 0, 0}, dv{0, 0, 0};
        Vec2d uv_du{0, 0}, uv_dv{0, 0};
    };
    std::shared_ptr<const Shape> base_;
    std::shared_ptr<const Displacement> displacement_;

    Vec3d local(const Vec3d& object) const { return (object - frame_.center) / frame_.scale; }
    const Vec3d& checked(const Vec3d& position) const;
    std::optional<Vec3d> moved_if_finite(const LocalHit& hit, const LocalSurface& surface) const;
    /// Throws InputError where it is not finite.
    Vec3d moved_in_object(const LocalHit& hit, const LocalSurface& surface) const;
    Moved moved(uint32_t element, const Vec2f& parameters) const;
    Slopes slopes(uint32_t element, const Vec2f& parameters) const;
};

}  // namespace rayleaf
