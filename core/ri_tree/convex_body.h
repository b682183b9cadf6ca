// A convex body of patches as lines cross it: where a line leaves is found by Newton's iteration, with no search.
//
// Idea: a line leaves a convex body once. The body lies behind every one of its tangent planes, so where a line leaves
// one of them bounds where it leaves the body; the tangent plane on the radius through that point bounds it more
// closely (this is Newton's iteration for the gauge function of the body along the line, which is convex: it closes in
// from outside). Tangent planes come from a table of surface points by the direction from the body's middle. The last
// one's place on its patch is where Newton's iteration begins on the patch itself; steps over a border go on in the
// patch beyond. Where a line enters is where its reverse leaves.
//
// Single precision, as the parameters of a hit everywhere. Answers are pure functions of body and line.
#pragma once

#include "geometry/shape.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace rayleaf {

class PatchSurface;

class ConvexBody {
  public:
    struct Crossing {
        Vec3d position{0, 0, 0}, normal{0, 0, 1};  ///< local space; unit, outward
        uint32_t element = 0;
        Vec2f at{0, 0};  ///< parameters there
    };

    /// Null unless the shape is one smooth spline of not too many patches, closed around and with a pole at either end,
    /// of degrees up to 3, wound outwards, not thin, and convex at all points of a dense lattice.
    static std::unique_ptr<const ConvexBody> of(const Shape& shape);

    enum class Meeting : uint8_t {
        Crossed,
        Missed,    ///< tangent planes of the body part the line from it
        Uncertain  ///< near silhouettes and poles
    };

    /// Where a line leaves; unit direction. The crossing is set if there is one.
    Meeting leave(const Vec3d& origin, const Vec3d& direction, Crossing& crossing) const;
    Meeting enter(const Vec3d& origin, const Vec3d& direction, Crossing& crossing) const {
        return leave(origin, -direction, crossing);
    }

  private:
    /// Bicubic, homogeneous; u fastest.
    struct alignas(16) Patch {
        float points[16][4];
    };
    /// A place in the lattice of patches.
    struct Place {
        std::array<int, 2> span{};
        Vec2f at{0, 0};
    };
    struct Tangent {
        Vec3f position{0, 0, 0}, du{0, 0, 0}, dv{0, 0, 0};
        Vec3f outward() const { return dv.cross(du); }  ///< not unit
    };
    /// A point of the lattice that the table knows.
    struct alignas(64) Seed {
        Tangent tangent;
        Vec3f normal{0, 0, 1};  ///< unit, outward
    };

    std::array<int, 2> spans_{};    ///< along u and v
    std::array<bool, 2> closed_{};  ///< exactly one of them
    bool rational_ = false;
    std::vector<Patch> patches_;
    std::vector<Seed> seeds_;
    std::vector<uint32_t> table_;  ///< numbers of seeds, by the cells of the faces of a cube
    Vec3d center_{0, 0, 0};
    double radius_ = 0;

    explicit ConvexBody(const PatchSurface& surface);
    void add_patches(const PatchSurface& surface);
    void add_seeds();
    bool is_convex(const PatchSurface& surface) const;
    void fill_table();

    std::array<int, 2> lattice() const;
    std::optional<uint32_t> neighbour(uint32_t seed, int step_u, int step_v) const;
    Place place_of(uint32_t seed) const;
    /// Of a line, by distance along it.
    struct Stretch {
        float begin = 0, end = 0;
    };
    Meeting close_in(const Vec3f& from, const Vec3f& along, Stretch& inside, const Seed*& seed) const;
    const Seed& seed_towards(const Vec3f& from_center) const;
    Tangent tangent_at(const Place& place) const;
    bool move(Place& place, const Vec2f& step) const;
};

}  // namespace rayleaf
