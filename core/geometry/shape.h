// Shapes, which a scene consists of, in their own local space, and the surface at a hit.
#pragma once

#include "base/content_hash.h"
#include "base/vector.h"
#include "rays/hit.h"

#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rayleaf {

/// Object space -> local space: `local = (object - center) / scale`. One frame per shape, so that borders shared inside
/// the shape stay bit-equal; all local coordinates lie in about [-1, 1], whatever the size and place of the object.
struct LocalFrame {
    Vec3d center{0, 0, 0};  ///< object units
    double scale = 1.0;     ///< a power of two, so that dividing by it is exact

    /// The frame that fits a box in object space. An empty or pointlike box gives scale 1.
    static LocalFrame fitting(const Box3d& box);

    Vec3f to_local(const Vec3d& object) const { return Vec3f((object - center) / scale); }
    /// Local space -> object space as an affine map.
    Affine3d to_object() const { return {{scale, 0, 0}, {0, scale, 0}, {0, 0, scale}, center}; }
};

/// The surface at a hit, in local space.
struct LocalSurface {
    Vec3d position{0, 0, 0};  ///< on the exact surface; for triangles the facet's own point
    Vec3f normal{0, 0, 1};    ///< unit shading normal, on the side of the winding; interpolated or exact where smooth
    Vec3f dp_du{0, 0, 0}, dp_dv{0, 0, 0};  ///< derivatives by the texture coordinate `uv`; zero where there is none
    Vec3f dn_du{0, 0, 0}, dn_dv{0, 0, 0};  ///< derivatives of the unit normal by the same; zero where flat
    Vec2f uv{0, 0};  ///< active texture coordinate: first UV map of a mesh, spline parameters of a surface
};

/// Named data over a shape ("UVMap", "Col"): an index into the scene's table of names.
using AttributeId = int32_t;
/// Where the surface was before modifiers and shape keys deformed it, object space, if they did: what Generated
/// coordinates are told by. With an alpha of 1 the place; with 0 what has to be added to the point's own.
inline constexpr AttributeId kRestPlace = -2;

struct VolumeGrids;  // geometry/volume_grids.h

/// A point chosen by parameters on an element.
struct ElementPoint {
    LocalHit hit;           ///< as if a ray had hit here
    Vec3f normal{0, 0, 1};  ///< unit, local space, of the exact surface, on the side of the winding
    float area_factor = 0;  ///< local area per unit of parameter area: |dP/du x dP/dv|; a triangle's whole area
};

/// A point chosen by parameters, and the surface there.
struct PlacedPoint {
    LocalHit hit;
    LocalSurface surface;
};

/// The hit at chosen parameters of a patch.
inline LocalHit placed_hit(uint32_t element, const Vec2f& parameters, const Vec3d& position, const Vec3f& normal) {
    LocalHit hit;
    hit.primitive = element;
    hit.u = parameters.x;
    hit.v = parameters.y;
    hit.position = position;
    hit.normal = normal;
    return hit;
}

/// How the point of a surface is wanted. Normal: its derivatives are not needed, which cost as much as the rest; dn_du
/// and dn_dv may be left unset.
enum class SurfaceDetail : uint8_t { Normal, Curvature };

/// A place on a border, in terms of one of the elements that meet there.
struct BorderPlace {
    uint32_t element = 0;
    Vec2f parameters{0, 0};
};

enum class ShapeKind { TriangleMesh, PatchSurface, Strands, SweptSurface, SubdivisionSurface, DisplacedSurface };
inline constexpr size_t kShapeKinds = static_cast<size_t>(ShapeKind::DisplacedSurface) + 1;

/// More material slots than Blender offers.
inline constexpr int32_t kLargestMaterialSlot = 65535;

/// Slots as shapes keep them; throws InputError naming the first that is out of range.
std::vector<uint16_t> checked_material_slots(const std::string& shape, std::span<const int32_t> slots);

/// A renderable shape. Immutable after construction; all threads read it. Constructors validate and throw InputError.
class Shape {
  public:
    Shape(ShapeKind kind, std::string name) : kind_(kind), name_(std::move(name)) {}
    virtual ~Shape() = default;
    Shape(const Shape&) = delete;
    Shape& operator=(const Shape&) = delete;

    ShapeKind kind() const { return kind_; }
    const std::string& name() const { return name_; }
    const LocalFrame& frame() const { return frame_; }
    /// Bounds in local space, at all times.
    const Box3f& bounds() const { return bounds_; }
    /// Bounds in object space before normalization, in the middle of the shutter's time.
    const Box3d& object_bounds() const { return object_bounds_; }
    /// The box, in object space, in which Blender's Generated coordinates run from 0 to 1: the bounds, unless another
    /// one is set, before anything is rendered.
    const Box3d& texture_space() const { return texture_space_.isEmpty() ? object_bounds_ : texture_space_; }
    void set_texture_space(const Box3d& box);

    /// The number of evenly spaced times of the shutter, from 0 to 1, at which the shape is given; its points go along
    /// lines in between. 1: it does not deform.
    size_t steps() const { return steps_; }
    bool deforms() const { return steps_ > 1; }

    /// Triangles, or Bezier patches before any splitting.
    virtual uint32_t element_count() const = 0;
    /// The surface at a hit. Pure; never NaN.
    virtual LocalSurface surface(const LocalHit& hit) const = 0;
    /// The same where the detail Normal will do.
    virtual LocalSurface surface_without_curvature(const LocalHit& hit) const { return surface(hit); }
    /// From a hit on a flat facet that is shaded smooth to the smooth surface that it stands for, local space; zero for
    /// shapes whose points lie on their surface.
    virtual Vec3d rise(const LocalHit& /*hit*/) const { return Vec3d(0.0); }
    /// Value of an attribute at a hit, missing channels 0, alpha 1; empty if the shape has no such attribute.
    virtual std::optional<Vec4f> attribute(AttributeId id, const LocalHit& hit) const = 0;
    /// Index into the instance's material slots for a primitive of a hit.
    virtual uint32_t material_slot(const LocalHit& hit) const = 0;
    /// Element that a hit lies on (a subpatch belongs to a patch) and the point of an element at parameters in [0,1]²
    /// (a triangle is covered once: parameters with u + v > 1 are mirrored into it). For light from emitting surfaces.
    virtual uint32_t element_of(const LocalHit& hit) const = 0;
    virtual ElementPoint element_point(uint32_t element, const Vec2f& parameters) const = 0;
    /// The same at a time of the shutter; `element_point` is in its middle.
    virtual ElementPoint element_point_at(uint32_t element, const Vec2f& parameters, float /*time*/) const {
        return element_point(element, parameters);
    }
    /// Points of an element along a line of constant u, one for each v: the results of element_point and surface.
    virtual void line_points(uint32_t element, float u, std::span<const float> v, PlacedPoint* points) const;
    /// Equal for shapes that look the same to rays, whatever their names; empty if not known. Computed once.
    const std::optional<ContentHash>& content_hash() const {
        std::call_once(hashed_, [this] { content_hash_ = hash_of_content(); });
        return content_hash_;
    }
    /// What fills it, where it bounds a volume; else null.
    virtual const VolumeGrids* grids() const { return nullptr; }
    /// Memory of the shape, including this object.
    virtual size_t bytes() const = 0;

  protected:
    virtual std::optional<ContentHash> hash_of_content() const { return std::nullopt; }
    /// Adds the common data of all shapes to a content hash.
    void add_to(ContentHasher& hasher) const {
        hasher.add(static_cast<int>(kind_));
        for (int axis = 0; axis < 3; ++axis) hasher.add(frame_.center[axis]);
        hasher.add(frame_.scale);
        for (int axis = 0; axis < 3; ++axis) {
            hasher.add(texture_space_.min[axis]);
            hasher.add(texture_space_.max[axis]);
        }
    }

    LocalFrame frame_;
    Box3f bounds_;
    Box3d object_bounds_;
    Box3d texture_space_;  ///< empty: the bounds
    size_t steps_ = 1;

  private:
    ShapeKind kind_;
    std::string name_;
    mutable std::once_flag hashed_;
    mutable std::optional<ContentHash> content_hash_;
};

}  // namespace rayleaf
