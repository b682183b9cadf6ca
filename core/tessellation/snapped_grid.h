// A grid as one ray sees it: some of its borders are snapped to a coarser level.
//
// A border whose level is lower than its grid's keeps only the vertices of that level; each of the others moves to the
// nearest of those. Triangles between two vertices that become one have no area, and no ray hits them. So both sides of
// a border have the same segments, whatever the levels of their subpatches. Only the blocks of 4 x 4 cells that a ray
// tests are moved.
#pragma once

#include "geometry/facet.h"
#include "tessellation/grid.h"
#include "tessellation/level.h"

namespace rayleaf {

/// One of the 4 x 4 parts, or parts of parts, that a subpatch is split into beyond the fine level.
struct GridPart {
    int level = kFine;  ///< of the subpatch: 4^(level - 2) parts along a side
    int u = 0, v = 0;   ///< which of them

    int parts_along() const { return quads_along(level - kFine); }
    uint32_t number() const { return static_cast<uint32_t>(v * parts_along() + u); }
    static GridPart numbered(int level, uint32_t number) {
        const uint32_t along = static_cast<uint32_t>(quads_along(level - kFine));
        return {level, static_cast<int>(number % along), static_cast<int>(number / along)};
    }
};

class SnappedGrid {
  public:
    SnappedGrid(const Grid& grid, const SubpatchLevels& levels);
    /// A grid without snapping.
    explicit SnappedGrid(const Grid& grid) : vertices_(&grid.vertices[0][0][0]), fine_(&grid), cells_(kGridCells) {}
    SnappedGrid(const MediumGrid& grid, const SubpatchLevels& levels);
    /// The one quad of the coarse level.
    explicit SnappedGrid(const SubpatchDetail& detail) : vertices_(&detail.corners[0][0]), cells_(1) {}
    /// A part of a subpatch; `whole` is the subpatch's fine grid.
    SnappedGrid(const Grid& part, const GridPart& place, const Grid& whole, const SubpatchLevels& levels);

    int cells() const { return cells_; }
    /// The fine grid; null for other levels.
    const Grid* fine() const { return fine_; }
    /// By axis: the vertices of a block.
    const float* block_vertices(int block) const { return vertices_ + block * 3 * kBlockSize; }
    /// Whether borders of a block are snapped.
    bool moves_block(int block) const { return (snapped_ & borders_of_block(block)) != 0; }
    /// A block with its borders snapped; out is [3][25].
    void move_block(int block, float* out) const;
    /// The blocks whose vertices may leave their box, one bit each.
    uint32_t blocks_beyond_boxes() const;

    /// Corners of a triangle, and where they lie in the grid: from (0, 0) to (cells, cells), or beyond where a part
    /// ends on its whole's border.
    struct Facet {
        FacetCorners corners;
        std::array<Vec2d, 3> places;

        Vec2d place(double weight1, double weight2) const {
            return places[0] + (places[1] - places[0]) * weight1 + (places[2] - places[0]) * weight2;
        }
    };
    Facet facet(uint32_t triangle) const;

  private:
    /// Where the vertices of a border move if it keeps at most its ends.
    struct Ends {
        Vec3f low, high;
        int low_place, high_place;  ///< along the border, in cells
        int first_high;             ///< vertices from here on go to the high end
    };

    const float* vertices_;
    const Grid* fine_ = nullptr;
    int cells_;
    uint32_t snapped_ = 0;  ///< a bit for each border that is snapped
    uint32_t to_ends_ = 0;  ///< those of them that go to `ends_`; the others to every fourth vertex
    Ends ends_[kBorders];   ///< not initialized unless used, to save time in every test

    uint32_t borders_of_block(int block) const;
    void snap_to_ends(int border, const Ends& ends);
    Vec3f grid_vertex(int i, int j) const;
    struct Vertex {
        Vec3f position;
        Vec2d place;
    };
    Vertex vertex(int i, int j) const;
};

}  // namespace rayleaf
