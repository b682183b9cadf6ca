// A triangle mesh with normals, texture coordinates and attributes per corner.
//
// Corner c of triangle t is entry 3 t + c of every per-corner array. A triangle without area keeps its number, but its
// three vertices are set equal, so that no ray can hit it.
#pragma once

#include "geometry/facet.h"
#include "geometry/shape.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rayleaf {

/// No attribute.
inline constexpr AttributeId kNoAttribute = -1;

/// Values of an attribute, one per corner; `channels` (1..4) floats each.
struct CornerAttribute {
    AttributeId id = kNoAttribute;
    int channels = 0;
    std::vector<float> values;
};

/// Quads: triangles 2 k and 2 k + 1 make the quadrangle a b c d as (a, b, d) and (c, d, b), and are traced as one.
enum class FacetLayout : uint8_t { Triangles, Quads };

/// The data of a mesh; the spans are read during construction only.
struct TriangleMeshArrays {
    std::string name;                         ///< for messages
    std::span<const float> vertices;          ///< x,y,z each, object space
    std::span<const int32_t> triangles;       ///< three vertex indices each, counter-clockwise seen from the outside
    std::span<const float> corner_normals;    ///< nine floats a triangle, object space; empty: flat
    std::span<const int32_t> material_slots;  ///< one a triangle; empty: slot 0 everywhere
    AttributeId active_uv = kNoAttribute;  ///< the attribute that is the surface's `uv`; the first two channels count
    std::vector<CornerAttribute> attributes;
    FacetLayout layout = FacetLayout::Triangles;
    /// Of a mesh that deforms, the vertices and normals at even times of the shutter, time by time; `vertices` and
    /// `corner_normals` are those in its middle. Without normals the middle's hold at all times.
    std::span<const float> moved_vertices = {}, moved_normals = {};
    std::shared_ptr<const VolumeGrids> grids = nullptr;  ///< of the box around a volume
};

class TriangleMesh final : public Shape {
  public:
    explicit TriangleMesh(TriangleMeshArrays arrays);

    uint32_t element_count() const override { return static_cast<uint32_t>(triangles_.size()); }
    LocalSurface surface(const LocalHit& hit) const override;
    Vec3d rise(const LocalHit& hit) const override;
    std::optional<Vec4f> attribute(AttributeId id, const LocalHit& hit) const override;
    uint32_t material_slot(const LocalHit& hit) const override;
    uint32_t element_of(const LocalHit& hit) const override { return hit.primitive; }
    ElementPoint element_point(uint32_t element, const Vec2f& parameters) const override {
        return element_point_at(element, parameters, kMiddleTime);
    }
    /// The place that a hit names, where its time has it.
    LocalHit point_at(LocalHit hit) const;
    ElementPoint element_point_at(uint32_t element, const Vec2f& parameters, float time) const override;
    std::optional<ContentHash> hash_of_content() const override;
    size_t bytes() const override;
    const VolumeGrids* grids() const override { return grids_.get(); }

    size_t vertex_count() const { return vertices_.size() / steps(); }
    /// Local space, at one of the steps.
    std::span<const Vec3f> vertices(size_t step = 0) const {
        return std::span(vertices_).subspan(step * vertex_count(), vertex_count());
    }
    /// Vertex indices; those of a triangle without area are all equal.
    const std::vector<std::array<uint32_t, 3>>& triangles() const { return triangles_; }
    /// False if every triangle shows its own flat normal.
    bool is_smooth() const { return !corner_normals_.empty(); }
    /// Of the mean of a triangle's unit corner normals at a hit: below 1 where they differ.
    float normal_length(const LocalHit& hit) const;
    /// At a time of the shutter.
    FacetCorners corners(uint32_t triangle, float time = kMiddleTime) const {
        return deforms() ? moved_corners(triangle, time) : corners_at(triangle, 0);
    }
    FacetLayout layout() const { return layout_; }

  private:
    FacetLayout layout_;
    std::vector<Vec3f> vertices_;  ///< step by step
    std::vector<std::array<uint32_t, 3>> triangles_;
    std::vector<Vec3f> corner_normals_;  ///< unit, of one step or of all; empty: flat
    std::vector<uint16_t> material_slots_;
    std::vector<CornerAttribute> attributes_;
    int active_uv_ = -1;  ///< index into attributes_
    std::shared_ptr<const VolumeGrids> grids_;

    void set_vertices(const TriangleMeshArrays& arrays);
    bool is_flat(uint32_t triangle) const;
    FacetCorners corners_at(uint32_t triangle, size_t step) const;
    FacetCorners moved_corners(uint32_t triangle, float time) const;
    std::array<Vec3f, 3> normals_at(uint32_t triangle, float time) const;
    void set_triangles(std::span<const int32_t> triangles);
    void set_corner_normals(std::span<const float> normals, size_t steps);
    void set_material_slots(std::span<const int32_t> slots);
    void set_attributes(std::vector<CornerAttribute> attributes, AttributeId active_uv);
    Vec2f corner_uv(uint32_t triangle, int corner) const;
    const CornerAttribute* find_attribute(AttributeId id) const;
};

}  // namespace rayleaf
