// A patch surface or subdivision surface with a material's displacement.
//
// Elements and their parameters are those of the base surface. The displacement of a point is a function of its place
// on that surface: position, normal, texture coordinates and attributes. Where elements meet these may differ, so every
// border has one owner, whose place is used for all (`owner_place` of the surfaces).
#pragma once

#include "base/cancel.h"
#include "base/content_hash.h"
#include "geometry/shape.h"

#include <memory>
#include <optional>
#include <span>

namespace rayleaf {

class Displacement {
  public:
    virtual ~Displacement() = default;
    /// The displacement vectors of points of the base surface, object space; their normals are on the outside. Pure:
    /// each vector depends on its point alone. The caller checks for NaN and infinity.
    virtual void offsets(const Shape& base, std::span<const PlacedPoint> points, Vec3d* offsets) const = 0;
    /// Of everything that the vectors depend on, beside the base surface; empty where that is not known.
    virtual std::optional<ContentHash> content_hash() const { return std::nullopt; }
};

class DisplacedSurface final : public Shape {
  public:
    /// What `content_hash` of such a surface is.
    static std::optional<ContentHash> hash_of(const Shape& base, const Displacement& displacement);
    static bool can_displace(const Shape& base) {
        return base.kind() == ShapeKind::PatchSurface || base.kind() == ShapeKind::SubdivisionSurface;
    }
    /// Throws InputError where a displacement is not finite, and Cancelled soon after `cancel` is set.
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
    std::optional<ContentHash> hash_of_content() const override { return hash_of(*base_, *displacement_); }
    size_t bytes() const override { return sizeof(*this) + base_->bytes(); }

    const Shape& base() const { return *base_; }
    /// The displaced point, local space, the same for all elements that meet there. Throws InputError if it is not
    /// finite, or far outside the range of the samples.
    Vec3d position(uint32_t element, const Vec2f& parameters) const;
    /// The same for points along a line of constant u, none on a border of the element: faster for many at a time.
    void line_positions(uint32_t element, float u, std::span<const float> v, Vec3d* positions) const;

  private:
    /// A displaced point as computed by one element.
    struct Moved {
        Vec3d position{0, 0, 0};  ///< local space
        LocalSurface base;        ///< the point below
        bool finite = true;       ///< else it has not been moved
    };
    /// A displaced point and its derivatives by the element's parameters, zero next to points that are not finite.
    struct Slopes {
        Moved here;
        Vec3d du{0, 0, 0}, dv{0, 0, 0};
        Vec2d uv_du{0, 0}, uv_dv{0, 0};
    };
    std::shared_ptr<const Shape> base_;
    std::shared_ptr<const Displacement> displacement_;

    Vec3d local(const Vec3d& object) const { return (object - frame_.center) / frame_.scale; }
    const Vec3d& checked(const Vec3d& position) const;
    void move_if_finite(std::span<const PlacedPoint> points, std::optional<Vec3d>* moved) const;
    /// Throws InputError where one is not finite.
    void move_in_object(std::span<const PlacedPoint> points, Vec3d* moved) const;
    void move(std::span<const PlacedPoint> points, Moved* moved) const;
    PlacedPoint placed(uint32_t element, const Vec2f& parameters) const;
    Slopes slopes(uint32_t element, const Vec2f& parameters) const;
};

}  // namespace rayleaf
