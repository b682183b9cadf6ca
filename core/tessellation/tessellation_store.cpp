#include "tessellation/tessellation_store.h"

#include "tessellation/dice.h"

namespace rayleaf {

TessellationStore::TessellationStore(const PatchSurface& surface, SplitPlan plan)
    : surface_(&surface),
      plan_(std::move(plan)),
      grids_(std::make_unique<std::atomic<const Grid*>[]>(plan_.subpatch_count())) {
    for (uint32_t i = 0; i < surface.splines().size(); ++i) {
        const SplinePatches& spline = surface.splines()[i];
        const SplineSplit& split = plan_.split(i);
        for (const auto& [degree, cells] :
             {std::pair(spline.degree_u, split.cells_u()), std::pair(spline.degree_v, split.cells_v())})
            bases_.try_emplace({degree, cells}, degree, cells);
    }
}

TessellationStore::~TessellationStore() {
    for (uint32_t i = 0; i < plan_.subpatch_count(); ++i) delete grids_[i].load(std::memory_order_relaxed);
}

void TessellationStore::dice_into(uint32_t index, Grid& grid) const {
    const Subpatch& subpatch = plan_.subpatch(index);
    const SplineSplit& split = plan_.split(subpatch.spline);
    const SplinePatches& spline = surface_->splines()[subpatch.spline];
    dice(surface_->patch(subpatch.patch), bases_.at({spline.degree_u, split.cells_u()}), subpatch.u * kGridCells,
         bases_.at({spline.degree_v, split.cells_v()}), subpatch.v * kGridCells, grid);
    diced_.fetch_add(1, std::memory_order_relaxed);
}

const Grid& TessellationStore::missing(uint32_t index) const {
    auto made = std::make_unique<Grid>();
    dice_into(index, *made);
    const Grid* expected = nullptr;
    if (!grids_[index].compare_exchange_strong(expected, made.get(), std::memory_order_acq_rel,
                                               std::memory_order_acquire))
        return *expected;
    kept_.fetch_add(1, std::memory_order_relaxed);
    return *made.release();
}

uint64_t TessellationStore::bytes() const {
    return kept_.load(std::memory_order_relaxed) * sizeof(Grid) + plan_.subpatch_count() * sizeof(grids_[0]);
}

}  // namespace rayleaf
