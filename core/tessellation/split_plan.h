// How the patches of a surface are split into subpatches: all patches of a spline alike, 2^a x 2^b, so that neighbours
// meet vertex to vertex; splines that share a border alike along it (shared_sides.h). What deforms is split as its
// finest form needs it.
//
// Subpatches are numbered patch by patch in the patches' order, within one first along u, then along v.
#pragma once

#include "geometry/patch_surface.h"
#include "splines/bounds.h"
#include "tessellation/dicer.h"
#include "tessellation/grid.h"
#include "tessellation/shared_sides.h"

#include <cstdint>
#include <vector>

namespace rayleaf {

/// The most subpatches of a shape, unless it has more patches: their tree and records take 50 MB. Subpatches that are
/// too coarse then are split when rays need it (tessellation/level.h).
inline constexpr uint32_t kMostSubpatches = 1u << 18;

/// A patch is split into at most 64 x 64: beyond that the error of single precision exceeds that of facets.
inline constexpr int kMostLog2 = 6;

struct SplineSplit {
    uint32_t first_subpatch = 0;
    int log2_u = 0, log2_v = 0;

    int cells_u() const { return kGridCells << log2_u; }
    int cells_v() const { return kGridCells << log2_v; }
    int& log2(int axis) { return axis == 0 ? log2_u : log2_v; }
};

/// The coarsest split of a patch, or of anything with such bounds, whose facets lie within `tolerance` of it.
SplineSplit split_for(const CurvatureBounds& bounds, double tolerance);

/// One cell of a split patch.
struct Subpatch {
    uint32_t patch = 0, spline = 0;
    int u = 0, v = 0;  ///< its place among the 2^a x 2^b
};

class SplitPlan {
  public:
    SplitPlan() = default;
    SplitPlan(const PatchSurface& surface, const FacetTolerance& tolerance, int extra_splits = 0);

    uint32_t subpatch_count() const { return static_cast<uint32_t>(subpatches_.size()); }
    const SplineSplit& split(uint32_t spline) const { return splits_[spline]; }
    const Subpatch& subpatch(uint32_t index) const { return subpatches_[index]; }
    /// The subpatch that holds the parameters of a patch.
    uint32_t index_at(const PatchSurface& surface, uint32_t patch, double u, double v) const;
    uint64_t bytes() const {
        return splits_.capacity() * sizeof(SplineSplit) + subpatches_.capacity() * sizeof(Subpatch);
    }

  private:
    std::vector<SplineSplit> splits_;
    std::vector<Subpatch> subpatches_;  ///< a table, since every hit asks for one

    void number(const PatchSurface& surface);
    void limit(const PatchSurface& surface, SharedSides& sides);
    uint64_t subpatches_wanted(const PatchSurface& surface) const;
};

}  // namespace rayleaf
