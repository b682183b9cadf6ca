// The limit of a face without creases and borders at its corners, as bicubic patches.
//
// One step of subdivision makes a face of any size to quads. A quad whose corners all have the regular four faces is
// one uniform bicubic B-spline patch; any other is divided again. What is left at irregular corners after
// kQuadtreeSteps is not held here.
#pragma once

#include "splines/bezier_patch.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace rayleaf {

/// After so many steps, less than a hundredth of a face with one irregular corner is left.
inline constexpr int kQuadtreeSteps = 4;

/// A corner of a face and what lies around it, counter-clockwise from the edge to the face's next corner; face i lies
/// between edges i and i + 1, and face 0 is the face itself.
struct CornerRing {
    Vec3d center{0, 0, 0};
    std::vector<Vec3d> edges;         ///< their other ends
    std::vector<Vec3d> face_middles;  ///< the mean of each face's corners
};

class LimitQuadtree {
  public:
    LimitQuadtree() = default;
    /// The rings of a face's corners, counter-clockwise; three faces at least around each.
    explicit LimitQuadtree(const std::vector<CornerRing>& corners);

    /// Parameters of a quad are those of the face. Otherwise there is one quad a corner, which lies at (0,0).
    size_t quad_count() const { return quads_; }
    /// Empty where the quadtree ends. Parameters within [0,1].
    std::optional<Vec3d> position(size_t quad, const Vec2d& parameters) const;
    class Walk;
    std::optional<PatchPoint> evaluate(size_t quad, const Vec2d& parameters) const;
    size_t bytes() const { return nodes_.capacity() * sizeof(Node); }

  private:
    static constexpr int kSide = 5;
    static constexpr int32_t kPatch = -1, kNothing = -2;

    /// A quad after one more step: its parts are patches of 4 x 4 points each, or other nodes, or nothing.
    struct Node {
        std::array<Vec3d, kSide * kSide> points;                       ///< along u first
        std::array<int32_t, 4> parts{kPatch, kPatch, kPatch, kPatch};  ///< counter-clockwise from (0,0)
    };
    /// A patch's lowest point and its place in it.
    struct InPatch {
        const Vec3d* points;
        Vec2d at;
        double per_quad;  ///< how much faster the patch's parameters advance
    };

    size_t quads_ = 0;
    std::vector<Node> nodes_;  ///< those of the quads first

    class Refined;
    void fill(size_t node, const Refined& quad, int steps_left);
    std::optional<InPatch> find(size_t quad, Vec2d at) const;
};

/// Positions one after another, faster where only u changes. Each has the same bits as alone.
class LimitQuadtree::Walk {
  public:
    explicit Walk(const LimitQuadtree& tree) : tree_(&tree) {}
    std::optional<Vec3d> position(size_t quad, const Vec2d& parameters);

  private:
    const LimitQuadtree* tree_;
    const Vec3d* points_ = nullptr;  ///< of the last patch
    double v_ = 0.0;                 ///< there
    Vec3d columns_[4];               ///< control points of the curve at v
};

}  // namespace rayleaf
