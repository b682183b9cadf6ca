// How dense a medium that varies is, cell by cell and piece by piece of a ray: at most, on average, and how far from
// that. Null collisions go by the first (Woodcock et al. 1965), estimates of transmittance by the others (Novak et al.
// 2014).
#pragma once

#include "base/cancel.h"
#include "base/vector.h"
#include "scene/cell_detail.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <span>
#include <vector>

namespace rayleaf {

/// The cells of a lattice over a box, x fastest.
struct BoundedCells {
    std::vector<DensityBounds> bounds;
    std::vector<CellDetail> details;
};

/// At points of an object's space; up to kMostPoints at once (shading/program.h).
using DensityLookup = std::function<void(std::span<const Vec3d> points, FoundDensity* found)>;

/// `cells` along each side of `box`, by what is found at points of them, with some reserve. Where a medium is denser
/// between them, it is rendered as dense as its bound (integrators/medium_tracking.cpp). Throws Cancelled soon after
/// `cancel` says so.
BoundedCells looked_up_cells(const Box3d& box, int cells, const DensityLookup& lookup, const CancelToken& cancel);

/// A ray in a grid's space.
struct GridLine {
    Vec3d origin, direction, per_direction;  ///< the last: reciprocals, 0 where there are none

    GridLine() = default;
    GridLine(const Vec3d& from, const Vec3d& towards);
};

class MajorantGrid {
  public:
    /// `cells` along each side of `box`.
    MajorantGrid(const Box3d& box, int cells, BoundedCells bounded);

  private:
    friend class GridWalk;

    Box3d box_;
    int cells_;
    Vec3d width_, per_width_;  ///< of a cell; the reciprocal, 0 along sides without length
    BoundedCells bounded_;
    DensityBounds largest_ = DensityBounds::none();  ///< what holds everywhere
};

/// Which parts of a ray have bounds of their own.
enum class BoundDetail : uint8_t {
    Cells,
    Pieces,  ///< of cells, where these have detail
};

/// The parts of a ray, from its origin, one after the other. Beyond the box: as dense as anywhere, for ever.
class GridWalk {
  public:
    GridWalk() = default;
    GridWalk(const MajorantGrid& grid, const GridLine& line, BoundDetail detail);

    const DensityBounds& bounds() const { return bounds_; }
    double end() const { return end_; }  ///< how far along the ray they hold
    void advance();

  private:
    /// Along one axis. The border of cell c is met at `base + step * c`.
    struct Axis {
        double base = 0, step = 0;
        double border = std::numeric_limits<double>::infinity();  ///< where the walk leaves its cell
        int next = 1, last = 0;  ///< number of that border; of the last inside the grid, in the walk's direction
        int turn = 1;            ///< to the next
        std::ptrdiff_t stride = 0;

        int cell() const { return turn > 0 ? next - 1 : next; }
        void find_border() { border = std::max(base + step * next, 0.0); }
    };
    /// Of the cell, if it has any.
    struct Pieces {
        int passed = 0, count = 0;
        double begin = 0, length = 0;  ///< of the first
        PiecesOfCell all;
    };
    std::array<Axis, 3> axes_;
    const MajorantGrid* grid_ = nullptr;
    BoundDetail detail_ = BoundDetail::Cells;
    size_t cell_ = 0;
    double cell_end_ = std::numeric_limits<double>::infinity(), end_ = cell_end_;
    double pieces_per_length_ = 0;
    Vec3d origin_{0.0}, direction_{0.0};  ///< in steps of CellDetail, from the grid's corner
    Pieces pieces_;
    DensityBounds bounds_ = DensityBounds::none();

    /// At `t`.
    void enter_cell(double t);
    void enter_piece();
};

}  // namespace rayleaf
