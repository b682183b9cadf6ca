// Where lines enter and leave a convex body of patches, found by Newton's iteration without a search.
//
// Idea: a line leaves a convex body once. The body lies behind each of its tangent planes, so the point where a line
// leaves a plane bounds the point where it leaves the body. The tangent plane on the radius through that point gives a
// closer bound: this is Newton's iteration for the body's gauge function along the line, which is convex, so it
// converges from outside. Tangent planes come from a table of surface points, by direction from the body's middle. From
// the last one, Newton's iteration goes on on the patch itself; steps over a border continue in the adjacent patch. A
// line enters where its reverse leaves.
//
// Single precision, like the parameters of all hits. Answers are pure functions of body and line.
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

    /// Null unless the shape is one smooth spline of a limited number of patches, closed around, with a pole at each
    /// end, of degrees up to 3, wound outwards, not thin, and convex at all points of a dense lattice.
    static std::unique_ptr<const ConvexBody> of(const Shape& shape);

    enum class Meeting : uint8_t {
        Crossed,
        Missed,    ///< a tangent plane separates the line from the body
        Uncertain  ///< near a silhouette or a pole
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
    /// A lattice point in the table.
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
    /// The part of a line that may be inside, as distances along it.
    struct Chord {
        float begin = 0, end = 0;
    };
    Meeting close_in(const Vec3f& from, const Vec3f& along, Chord& inside, const Seed*& seed) const;
    const Seed& seed_towards(const Vec3f& from_center) const;
    Tangent tangent_at(const Place& place) const;
    bool move(Place& place, const Vec2f& step) const;
};

}  // namespace rayleaf
