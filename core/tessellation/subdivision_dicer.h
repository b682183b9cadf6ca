// Elements of a subdivision surface, split for a view (ring_splits.h) and diced.
//
// Elements of one bicubic patch are diced like splines (dice.h), and so are all their borders. The vertices of other
// elements are evaluated in double, on a border by its owner.
#pragma once

#include "geometry/subdivision_surface.h"
#include "tessellation/dice.h"
#include "tessellation/dicer.h"
#include "tessellation/dyadic_basis.h"
#include "tessellation/ring_splits.h"

#include <map>

namespace rayleaf {

class SubdivisionDicer final : public LevelDicer {
  public:
    /// The surface must outlive this. `extra_splits`: additional splits in each direction, beyond the tolerance.
    SubdivisionDicer(const SubdivisionSurface& surface, const FacetTolerance& tolerance, int extra_splits = 0);
    /// Dices another form of a surface in the same way.
    SubdivisionDicer(const SubdivisionSurface& surface, const SubdivisionDicer& like);

    uint32_t subpatch_count() const override { return splits_.subpatch_count(); }
    ElementPlace element_place(const PlaceInGrid& place, const Vec3d& position) const override;
    std::optional<PlaceInGrid> place_in_grid(const ElementPlace& place) const override;
    size_t bytes() const override;

  private:
    const SubdivisionSurface* surface_;
    RingSplits splits_;
    std::map<int, DyadicBasis> bases_;  ///< by intervals

    /// The vertices of a grid along one direction of its element.
    struct Span {
        int first = 0, intervals = 0;  ///< of the whole element

        double at(int k) const { return static_cast<double>(first + k) / intervals; }
        bool at_begin(int k) const { return first + k == 0; }
        bool at_end(int k) const { return first + k == intervals; }
    };
    void dice_level(uint32_t subpatch, int level, const VertexRows& target) const override;
    void dice_part_rows(uint32_t subpatch, const GridPart& part, const VertexRows& target) const override;
    void dice_spans(uint32_t element, const Span& u, const Span& v, const DiceAxis& axis_u, const DiceAxis& axis_v,
                    const VertexRows& target) const;
    void evaluate_irregular(uint32_t element, const Span& u, const Span& v, const VertexRows& target) const;
};

}  // namespace rayleaf
