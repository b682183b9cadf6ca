// The facets of a curve's filled areas. Their border vertices are those of the walls, bit by bit.
#pragma once

#include "tessellation/grid.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace rayleaf {

/// A vertex in steps of the local space's grid.
using FixedVertex = std::array<int32_t, 3>;

inline int32_t fixed_number(double local) {
    return static_cast<int32_t>(std::lrint(local / kFixedStep));
}

enum class FillFacing : uint8_t { Upwards, Downwards };

/// Triangles in strips: the cells between the first two columns of a grid; the other cells have no area.
class FillCells {
  public:
    /// Polygon k has the vertices from begins[k] on, up to begins[k + 1]; the last entry is their number. Outlines run
    /// counter-clockwise seen from above, holes the other way.
    FillCells(std::vector<FixedVertex> vertices, const std::vector<uint32_t>& begins, FillFacing facing);

    uint32_t grids() const { return static_cast<uint32_t>(rungs_.size() / kGridVertices); }
    /// The vertices of a grid, [j][i].
    void place(uint32_t grid, Vec3d (&vertices)[kGridVertices][kGridVertices]) const;
    size_t bytes() const;

    /// A line across a strip, by its two ends.
    struct Rung {
        uint32_t left = 0, right = 0;
    };

  private:
    std::vector<FixedVertex> vertices_;
    std::vector<Rung> rungs_;  ///< kGridVertices for each grid

    void add_strip(const std::vector<Rung>& strip);
    void fill_up_grid();
};

}  // namespace rayleaf
