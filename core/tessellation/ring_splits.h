// How the elements of a subdivision surface are split into subpatches. Opposite borders of an element are split alike,
// so that neighbours meet vertex to vertex; such borders make rings (or strips) around the surface.
//
// Subpatches are numbered element by element, within one first along u, then along v.
#pragma once

#include "geometry/subdivision_surface.h"
#include "tessellation/dicer.h"

#include <cstdint>
#include <vector>

namespace rayleaf {

/// One cell of a split element.
struct ElementCell {
    uint32_t element = 0;
    int u = 0, v = 0;  ///< its place among the 2^a x 2^b
};

class RingSplits {
  public:
    RingSplits(const SubdivisionSurface& surface, const FacetTolerance& tolerance, int extra_splits);

    uint32_t subpatch_count() const { return static_cast<uint32_t>(cells_.size()); }
    const ElementCell& cell(uint32_t subpatch) const { return cells_[subpatch]; }
    int log2_u(uint32_t element) const { return splits_[element].log2_u; }
    int log2_v(uint32_t element) const { return splits_[element].log2_v; }
    uint32_t first_subpatch(uint32_t element) const { return splits_[element].first; }
    uint64_t bytes() const { return splits_.capacity() * sizeof(Split) + cells_.capacity() * sizeof(ElementCell); }

  private:
    struct Split {
        uint32_t first = 0;
        uint8_t log2_u = 0, log2_v = 0;
    };
    std::vector<Split> splits_;       ///< by element
    std::vector<ElementCell> cells_;  ///< a table, since every hit asks for one

    void limit();
    void number();
};

}  // namespace rayleaf
