// Patches of splines, split evenly for a view (split_plan.h) and diced in single precision (dice.h).
#pragma once

#include "geometry/patch_surface.h"
#include "tessellation/dicer.h"
#include "tessellation/dyadic_basis.h"
#include "tessellation/split_plan.h"

#include <map>
#include <utility>

namespace rayleaf {

class PatchDicer final : public Dicer {
  public:
    PatchDicer(const PatchSurface& surface, const FacetTolerance& tolerance);

    uint32_t subpatch_count() const override { return plan_.subpatch_count(); }
    void dice(uint32_t subpatch, Grid& grid) const override;
    ElementPlace element_place(const PlaceInGrid& place, const Vec3d& position) const override;
    std::optional<PlaceInGrid> place_in_grid(const ElementPlace& place) const override;
    size_t bytes() const override;

  private:
    const PatchSurface* surface_;
    SplitPlan plan_;
    std::map<std::pair<int, int>, DyadicBasis> bases_;  ///< by degree and cells
};

}  // namespace rayleaf
