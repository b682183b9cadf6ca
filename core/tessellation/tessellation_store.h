// The grids of one surface, diced when they are first asked for and kept.
//
// A grid is a pure function of (surface, split, subpatch), so it does not matter who dices it, or how often: a thread
// that misses one dices it and offers it; if another was faster, its own copy is dropped. No one waits.
#pragma once

#include "geometry/patch_surface.h"
#include "tessellation/dyadic_basis.h"
#include "tessellation/grid.h"
#include "tessellation/split_plan.h"

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace rayleaf {

class TessellationStore {
  public:
    TessellationStore(const PatchSurface& surface, SplitPlan plan);
    ~TessellationStore();
    TessellationStore(const TessellationStore&) = delete;
    TessellationStore& operator=(const TessellationStore&) = delete;

    const SplitPlan& plan() const { return plan_; }
    uint32_t subpatch_count() const { return plan_.subpatch_count(); }
    const Grid& grid(uint32_t subpatch) const {
        const Grid* found = grids_[subpatch].load(std::memory_order_acquire);
        return found ? *found : missing(subpatch);
    }
    /// Dices without keeping.
    void dice_into(uint32_t subpatch, Grid& grid) const;

    /// All grids that were diced, those dropped included.
    uint64_t diced() const { return diced_.load(std::memory_order_relaxed); }
    /// What is held.
    uint64_t bytes() const;

  private:
    const PatchSurface* surface_;
    SplitPlan plan_;
    std::map<std::pair<int, int>, DyadicBasis> bases_;  ///< by degree and cells
    std::unique_ptr<std::atomic<const Grid*>[]> grids_;
    mutable std::atomic<uint64_t> diced_{0}, kept_{0};

    const Grid& missing(uint32_t subpatch) const;
};

}  // namespace rayleaf
