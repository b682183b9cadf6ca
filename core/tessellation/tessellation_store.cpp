#include "tessellation/tessellation_store.h"

namespace rayleaf {

TessellationStore::TessellationStore(std::unique_ptr<const Dicer> dicer)
    : dicer_(std::move(dicer)),
      count_(dicer_->subpatch_count()),
      grids_(std::make_unique<std::atomic<const Grid*>[]>(count_)) {}

TessellationStore::~TessellationStore() {
    for (uint32_t i = 0; i < count_; ++i) delete grids_[i].load(std::memory_order_relaxed);
}

void TessellationStore::dice_into(uint32_t subpatch, Grid& grid) const {
    dicer_->dice(subpatch, grid);
    diced_.fetch_add(1, std::memory_order_relaxed);
}

const Grid& TessellationStore::missing(uint32_t subpatch) const {
    if (kept_.load(std::memory_order_relaxed) >= kMostKeptGrids) {
        thread_local Grid scratch;
        dice_into(subpatch, scratch);
        return scratch;
    }
    auto made = std::make_unique<Grid>();
    dice_into(subpatch, *made);
    const Grid* expected = nullptr;
    if (!grids_[subpatch].compare_exchange_strong(expected, made.get(), std::memory_order_acq_rel,
                                                  std::memory_order_acquire))
        return *expected;
    kept_.fetch_add(1, std::memory_order_relaxed);
    return *made.release();
}

uint64_t TessellationStore::bytes() const {
    return kept_.load(std::memory_order_relaxed) * sizeof(Grid) + count_ * sizeof(grids_[0]);
}

}  // namespace rayleaf
