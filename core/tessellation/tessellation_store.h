// The grids of one surface, diced when they are first asked for and kept.
//
// A grid is a pure function of (dicer, subpatch), so it does not matter who dices it, or how often: a thread that
// misses one dices it and offers it; if another was faster, its own copy is dropped. No one waits. Beyond
// kMostKeptGrids a grid is diced for the moment into the thread's own.
#pragma once

#include "tessellation/dicer.h"
#include "tessellation/grid.h"

#include <atomic>
#include <cstdint>
#include <memory>

namespace rayleaf {

/// The most grids of one surface that are kept: 700 MB.
inline constexpr uint64_t kMostKeptGrids = 1u << 17;

class TessellationStore {
  public:
    explicit TessellationStore(std::unique_ptr<const Dicer> dicer);
    ~TessellationStore();
    TessellationStore(const TessellationStore&) = delete;
    TessellationStore& operator=(const TessellationStore&) = delete;

    const Dicer& dicer() const { return *dicer_; }
    uint32_t subpatch_count() const { return count_; }
    /// Valid until this thread asks for another one.
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
    std::unique_ptr<const Dicer> dicer_;
    uint32_t count_;
    std::unique_ptr<std::atomic<const Grid*>[]> grids_;
    mutable std::atomic<uint64_t> diced_{0}, kept_{0};

    const Grid& missing(uint32_t subpatch) const;
};

}  // namespace rayleaf
