// A displaced surface: the subpatches of the base surface, with their vertices moved.
//
// Vertices are computed one by one, in double, at their exact parameters, so all levels share them bit by bit. No level
// is finer than the fine one: rays only meet vertices that are inside the measured boxes.
#pragma once

#include "geometry/displaced_surface.h"
#include "tessellation/dicer.h"

#include <memory>

namespace rayleaf {

class DisplacedDicer final : public LevelDicer {
  public:
    /// The surface must live as long.
    DisplacedDicer(const DisplacedSurface& surface, const FacetTolerance& tolerance);

    uint32_t subpatch_count() const override { return below_->subpatch_count(); }
    ElementPlace element_place(const PlaceInGrid& place, const Vec3d& position) const override {
        return below_->element_place(place, position);
    }
    std::optional<PlaceInGrid> place_in_grid(const ElementPlace& place) const override {
        return below_->place_in_grid(place);
    }
    size_t bytes() const override { return sizeof(*this) + below_->bytes(); }
    int finest_level() const override { return kFine; }
    bool is_slow() const override { return true; }

  private:
    const DisplacedSurface* surface_;
    std::unique_ptr<const Dicer> below_;

    bool is_fine_enough(const FacetTolerance& tolerance) const;
    void dice_level(uint32_t subpatch, int level, const VertexRows& target) const override;
    void dice_part_rows(uint32_t subpatch, const GridPart& part, const VertexRows& target) const override;
    void dice_from(uint32_t subpatch, const Vec2d& first, double step, const VertexRows& target) const;
};

}  // namespace rayleaf
