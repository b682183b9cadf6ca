// The limit of a cage as a shape: every face is one element, or one for each of its corners.
//
// In a connected set of quads, an element is a face; in any other, all faces are divided at the middles of their edges,
// so that elements always meet border to border. The parameters of an element run from its first corner towards the
// previous one (u) and the next one (v): the outside is the side of P_v x P_u, as for other patches.
//
// Borders are not part of elements: their ends are nodes and the curves between them lines, each stored once, so that
// all elements that meet there agree on every bit. Elements that are one bicubic patch are stored as such; the others
// are evaluated by OpenSubdiv, and a line between two of these by the element that owns it.
#pragma once

#include "geometry/facet.h"
#include "geometry/limit_faces.h"
#include "geometry/moments.h"
#include "geometry/shape.h"
#include "geometry/subdivision_cage.h"
#include "splines/limit_normal.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

namespace rayleaf {

struct SubdivisionElement {
    static constexpr uint32_t kIrregular = 0xffffffffu;

    uint32_t face = 0;
    uint32_t corner = 0;              ///< its first
    uint32_t net = kIrregular;        ///< which bicubic patch
    bool whole = true;                ///< of the face
    std::array<uint32_t, 4> nodes{};  ///< at (0,0), (1,0), (0,1), (1,1)
    std::array<uint32_t, 4> lines{};  ///< at v = 0, u = 1, v = 1, u = 0
    FaceSquare square;                ///< in the face's parameters
};

/// The border between elements, in the direction from the lower node to the higher one.
struct SubdivisionLine {
    uint32_t owner = 0;                                  ///< the element that defines it
    uint8_t border = 0;                                  ///< of the owner
    bool cubic = false;                                  ///< the inner points describe it
    std::array<Vec3d, 2> inner{Vec3d(0.0), Vec3d(0.0)};  ///< from the lower node
};

class SubdivisionSurface final : public Shape {
  public:
    /// Invalid data throws InputError.
    explicit SubdivisionSurface(const SubdivisionCage& cage);

    uint32_t element_count() const override { return static_cast<uint32_t>(elements_.size()); }
    LocalSurface surface(const LocalHit& hit) const override;
    std::optional<Vec4f> attribute(AttributeId id, const LocalHit& hit) const override;
    uint32_t material_slot(const LocalHit& hit) const override {
        return slots_.empty() ? 0u : slots_[elements_[hit.primitive].face];
    }
    uint32_t element_of(const LocalHit& hit) const override { return hit.primitive; }
    ElementPoint element_point(uint32_t element, const Vec2f& parameters) const override {
        return element_point_at(element, parameters, kMiddleTime);
    }
    ElementPoint element_point_at(uint32_t element, const Vec2f& parameters, float time) const override;
    void line_points(uint32_t element, float u, std::span<const float> v, PlacedPoint* points) const override;
    std::optional<ContentHash> hash_of_content() const override { return hash_; }
    size_t bytes() const override;

    /// The surface at one of its steps: itself, where it does not deform. What follows is of its middle.
    const SubdivisionSurface& form(size_t step) const {
        return deforms() ? static_cast<const SubdivisionSurface&>(moments_[step]) : *this;
    }
    const SubdivisionElement& element(uint32_t index) const { return elements_[index]; }
    const SubdivisionLine& line(uint32_t index) const { return lines_[index]; }
    uint32_t line_count() const { return static_cast<uint32_t>(lines_.size()); }
    uint32_t node_count() const { return static_cast<uint32_t>(nodes_.size()); }
    /// Local space.
    const Vec3d& node(uint32_t index) const { return nodes_[index]; }
    /// The bicubic patch of an element that has one.
    PatchView net(const SubdivisionElement& element) const {
        return {3, 3, false, &nets_[size_t{16} * element.net], 4};
    }
    /// The point of an element, evaluated by the element even on borders.
    PatchPoint evaluate(uint32_t element, double u, double v) const;
    Vec3d position(uint32_t element, double u, double v) const;
    /// Positions of an element that is not one bicubic patch, along a line of constant u.
    void irregular_positions(uint32_t element, double u, std::span<const double> v, Vec3d* positions) const;
    /// The point of a border by its owner; `at` from the lower node.
    Vec3d line_position(uint32_t line, double at) const;
    /// The same point by its owner, which all elements that meet there use.
    BorderPlace owner_place(const BorderPlace& place) const;
    /// Whether a border has the opposite direction of its line.
    bool is_reversed(const SubdivisionElement& element, int border) const {
        return element.nodes[kBorderEnds[border][0]] > element.nodes[kBorderEnds[border][1]];
    }
    NormalCounters limit_normals() const;

  private:
    struct UvMap {
        AttributeId id = kNoAttribute;
        LimitFaces limit;
    };
    std::vector<SubdivisionElement> elements_;
    std::vector<SubdivisionLine> lines_;
    std::vector<Vec3d> nodes_;
    std::vector<uint32_t> node_owners_;   ///< the elements that define them
    std::vector<Vec4d> nets_;             ///< 16 points each, u fastest
    LimitFaces limit_;                    ///< of irregular faces
    std::vector<uint32_t> first_corner_;  ///< of each face, and the end
    std::vector<uint16_t> slots_;
    std::vector<UvMap> uv_maps_;
    std::vector<CornerAttribute> attributes_;
    CornerAttribute corner_normals_;  ///< without values if the limit's own normal is used
    int active_uv_ = -1;              ///< index into uv_maps_
    ContentHash hash_{};
    Moments moments_;  ///< of a surface that deforms
    mutable std::array<std::atomic<uint64_t>, kNormalStageCount> limit_normals_{};

    /// `extent`: what the frame must hold beside the cage, object space.
    SubdivisionSurface(const SubdivisionCage& cage, const Box3d& extent);
    void add_moments(const SubdivisionCage& cage, const Box3d& extent);
    void add_elements(const CageTopology& topology, const SubdivisionCage& cage);
    void find_owners();
    void place_nodes();
    void make_nets();
    PatchPoint in_element(const LimitFaces& limit, const SubdivisionElement& element, double u, double v) const;
    PatchPoint evaluate_at(uint32_t element, double u, double v, float time) const;
    LimitNormal normal_at(uint32_t element, double u, double v, const PatchPoint& point, const Vec3d& geometric,
                          float time) const;
    LocalSurface surface(const LocalHit& hit, const PatchPoint& point, const std::optional<LimitNormal>& known) const;
    /// The custom or limit normal, on the side of `facet_normal` (unit).
    Vec3f shading_normal(const LocalHit& hit, const Vec3f& of_limit, const Vec3f& facet_normal) const;
    /// An attribute's value, bilinear within the face; missing channels 0, alpha 1.
    Vec4f interpolated(const CornerAttribute& attribute, const LocalHit& hit) const;
    void set_texture_coordinates(const LocalHit& hit, const PatchPoint& point, const LimitNormal& normal, double side,
                                 LocalSurface& result) const;
};

}  // namespace rayleaf
