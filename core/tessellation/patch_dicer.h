// Patches of splines, split evenly for a view (split_plan.h) and diced in single precision (dice.h).
#pragma once

#include "geometry/patch_surface.h"
#include "tessellation/dice.h"
#include "tessellation/dicer.h"
#include "tessellation/dyadic_basis.h"
#include "tessellation/split_plan.h"

#include <array>
#include <map>
#include <vector>

namespace rayleaf {

class PatchDicer final : public LevelDicer {
  public:
    /// The surface must outlive this. `extra_splits`: additional splits in each direction, beyond the tolerance.
    PatchDicer(const PatchSurface& surface, const FacetTolerance& tolerance, int extra_splits = 0);
    /// Dices another form of a surface in the same way.
    PatchDicer(const PatchSurface& surface, const PatchDicer& like);

    uint32_t subpatch_count() const override { return plan_.subpatch_count(); }
    ElementPlace element_place(const PlaceInGrid& place, const Vec3d& position) const override;
    std::optional<PlaceInGrid> place_in_grid(const ElementPlace& place) const override;
    size_t bytes() const override;

  private:
    /// By level; null for the coarse one.
    using LevelBases = std::array<const DyadicBasis*, kStoredLevels>;
    struct SplineBases {
        LevelBases u{}, v{};
    };

    const PatchSurface* surface_;
    SplitPlan plan_;
    std::map<std::pair<int, int>, DyadicBasis> bases_;  ///< by degree and intervals
    std::vector<SplineBases> of_spline_;

    void add_bases();
    LevelBases level_bases(int degree, int log2);
    void dice_level(uint32_t subpatch, int level, const VertexRows& target) const override;
    void dice_part_rows(uint32_t subpatch, const GridPart& part, const VertexRows& target) const override;
};

}  // namespace rayleaf
