// The facets of a diced surface that stay in memory: blocks of 4 x 4 cells, each with its own copy of its 5 x 5
// vertices, as fine as the view needs and no finer.
//
// A subpatch has 2^k cells along a side, k from 0 to 4. Its borders have resolutions of their own, from numbers that
// both neighbours hold with the same bits; the finer side's vertices there move to the nearest ones that are kept, so
// no crack opens. Cells between two vertices that become one have no area, and no ray hits them.
#pragma once

#include "base/cancel.h"
#include "base/large_memory.h"
#include "geometry/facet.h"
#include "tessellation/dicer.h"
#include "tessellation/level.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace rayleaf {

/// How finely a subpatch is diced: logarithms to base 2 of the cells along its sides. No border's is larger than `own`.
struct Resolution {
    static constexpr int kFinest = 4;
    static_assert(1 << kFinest == kGridCells);
    uint8_t own = kFinest;
    std::array<uint8_t, kBorders> border{kFinest, kFinest, kFinest, kFinest};

    int cells() const { return 1 << own; }
    /// Whether its vertices are more than those of a MediumGrid.
    bool needs_fine_grid() const { return cells() > kBlockCells; }
    /// Blocks along a side.
    int blocks() const { return own <= 2 ? 1 : cells() / kBlockCells; }
};

/// Of each subpatch its fine grid, or null.
using MeasuredGrids = std::vector<std::unique_ptr<const GridRows>>;

/// A surface as it is at one time, diced as it is at the others, and its subpatches; none for dicers without levels.
struct DicedForm {
    const Dicer* dicer;
    std::span<const SubpatchDetail> details;
    std::span<const MeasuredGrids::value_type> grids;  ///< those that are known need not be diced; may be empty
};

/// The coarsest resolution of a subpatch whose facets lie within the tolerance of the surface at all times.
Resolution resolution_for(std::span<const DicedForm> forms, uint32_t subpatch, const FacetTolerance& tolerance);

/// Not initialized.
struct alignas(64) FacetBlock {
    /// By axis, vertex (i, j) at j * 5 + i. Fixed numbers (VertexFormat::Fixed) or floats, as the dicer has it. A block
    /// of a subpatch of fewer than 4 x 4 cells repeats the last row and column.
    union {
        float vertices[3][kBlockSize];
        int32_t fixed[3][kBlockSize];
    };
    uint32_t subpatch;
    uint32_t facets;      ///< a bit for each triangle whose corners differ: others have no area, and are not asked
    uint8_t column, row;  ///< first cell, in cells of the subpatch

    /// Sets `facets` by the vertices.
    void note_facets(VertexFormat format);
    Vec3d vertex(int index, VertexFormat format) const {
        if (format == VertexFormat::Fixed) return Vec3d(fixed[0][index], fixed[1][index], fixed[2][index]) * kFixedStep;
        return {vertices[0][index], vertices[1][index], vertices[2][index]};
    }
    /// Triangle 2 * (j * 4 + i) of cell (i, j), or the one after it, cut and wound as those of a Grid.
    FacetCorners corners(uint32_t triangle, VertexFormat format) const;
};

class FacetBlocks {
  public:
    /// What there would be to hold. `forms` are those at even times of the shutter; one of what does not deform.
    FacetBlocks(std::span<const DicedForm> forms, const FacetTolerance& tolerance);

    uint64_t block_count() const { return first_.back(); }
    /// Once filled.
    uint64_t bytes() const {
        return block_count() * block_bytes() + first_.capacity() * sizeof(first_[0]) +
               resolutions_.capacity() * sizeof(Resolution);
    }
    /// Of one block at all times.
    uint64_t block_bytes() const { return sizeof(FacetBlock) * steps_; }
    /// Dices everything. Throws Cancelled soon after `cancel` says so.
    void fill(std::span<const DicedForm> forms, const CancelToken& cancel);

    /// At the first time; those of the others follow it.
    const FacetBlock& operator[](uint32_t block) const { return blocks_[block * steps_]; }
    /// At a time of the shutter, mixed in `room` where facets move.
    const FacetBlock& at(uint32_t block, float time, FacetBlock& room) const {
        if (steps_ == 1) return blocks_[block];
        mix(block, time, room);
        return room;
    }
    FacetCorners corners(uint32_t block, uint32_t triangle, float time) const {
        FacetBlock room;
        return at(block, time, room).corners(triangle, format_);
    }
    const Resolution& resolution(uint32_t subpatch) const { return resolutions_[subpatch]; }
    /// Box of a block's vertices, padded as a Grid's blocks are: at all times, or at a step.
    Box3f box(uint32_t block) const;
    Box3f box_at(uint32_t block, size_t step) const;
    /// All vertices at all times.
    std::vector<Vec3d> vertices() const;
    /// Where in the subpatch's grid of 16 x 16 cells a point of a triangle lies; weights of its corners 1 and 2.
    Vec2d place(uint32_t block, uint32_t triangle, double weight1, double weight2) const;
    /// The triangle at a place, and the weights there.
    struct Facet {
        uint32_t block = 0, triangle = 0;
        double weight1 = 0, weight2 = 0;
    };
    Facet facet_at(const PlaceInGrid& place) const;

  private:
    VertexFormat format_;
    std::vector<Resolution> resolutions_;
    std::vector<uint64_t> first_;  ///< of each subpatch, its first block; at the end, their number
    size_t steps_;
    LargeArray<FacetBlock> blocks_;  ///< block by block, each at all times

    FacetBlock& block_of(uint32_t subpatch, int number, size_t step) {
        return blocks_[(first_[subpatch] + static_cast<uint64_t>(number)) * steps_ + step];
    }
    void mix(uint32_t block, float time, FacetBlock& room) const;
    void fill_levels(const DicedForm& form, uint32_t subpatch, size_t step);
    void fill_fixed(const Dicer& dicer, uint32_t subpatch);
};

/// Where vertex (i, j) of a subpatch's own cells lies in its grid of 16 x 16 cells, once borders are drawn to theirs.
struct GridVertex {
    int i = 0, j = 0;
};
GridVertex drawn_vertex(const Resolution& resolution, int i, int j);

}  // namespace rayleaf
