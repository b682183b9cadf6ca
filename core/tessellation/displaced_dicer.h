// A displaced surface: the subpatches of the surface below, their vertices moved.
//
// Vertices are computed one by one, in double, at their exact parameters, so all levels share them bit by bit. No
// level is finer than the fine one: what rays meet are vertices that the boxes were measured from.
#pragma once

#include "geometry/displaced_surface.h"
#include "tessellation/dicer.h"

#include <memory>

namespace rayleaf {

class DisplacedDicer final : public Dicer, public LevelDicer {
  public:
    /// The surface must live as long.
    DisplacedDicer(const DisplacedSurface& surface, const FacetTolerance& tolerance);

    uint32_t subpatch_count() const override { return below_->subpatch_count(); }
    void dice(uint32_t subpatch, Grid& grid) const override;
    ElementPlace element_place(const PlaceInGrid& place, const Vec3d& position) const override {
        return below_->element_place(place, position);
    }
    std::optional<PlaceInGrid> place_in_grid(const ElementPlace& place) const override {
        return below_->place_in_grid(place);
    }
    size_t bytes() const override { return sizeof(*this) + below_->bytes(); }
    const LevelDicer* levels() const override { return this; }

    void dice_rows(uint32_t subpatch, GridRows& rows) const override;
    void dice_medium(uint32_t subpatch, MediumGrid& grid) const override;
    void dice_coarse(uint32_t subpatch, CoarseGrid& grid) const override;
    void dice_part(uint32_t subpatch, const GridPart& part, GridRows& rows) const override;
    int finest_level() const override { return kFine; }

  private:
    const DisplacedSurface* surface_;
    std::unique_ptr<const Dicer> below_;

    bool is_fine_enough(const FacetTolerance& tolerance) const;
    template <typename Target>
    void dice_at(uint32_t subpatch, const Vec2d& first, double step, int quads, Target& target) const;
};

}  // namespace rayleaf
