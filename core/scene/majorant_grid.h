// How dense a medium that varies may be at most, cell by cell: what null collisions go by (Woodcock et al. 1965).
//
// The bound is looked up at points of a lattice, with some reserve. Where a medium is denser between them, it is
// rendered as dense as its bound (integrators/medium_tracking.cpp).
#pragma once

#include "base/cancel.h"
#include "base/vector.h"

#include <functional>
#include <span>
#include <vector>

namespace rayleaf {

/// What a ray finds at a place of the grid.
struct MajorantStep {
    float majorant = 0;  ///< extinction of the densest channel, per world unit
    double end = 0;      ///< how far along the ray it holds
};

/// A ray in a grid's space.
struct GridLine {
    Vec3d origin, direction, per_direction;  ///< the last: reciprocals, 0 where there are none

    GridLine() = default;
    GridLine(const Vec3d& from, const Vec3d& towards);
};

class MajorantGrid {
  public:
    /// Extinction's largest channel at points of the grid's own space; up to kMostPoints at once (shading/program.h).
    using Extinctions = std::function<void(std::span<const Vec3d> points, float* extinctions)>;

    /// `cells` along each side of `box`. Throws Cancelled soon after `cancel` says so.
    MajorantGrid(const Box3d& box, int cells, const Extinctions& extinctions, const CancelToken& cancel);

    /// Of bounds that are known, x fastest.
    MajorantGrid(const Box3d& box, int cells, std::vector<float> majorants);

    /// Along a ray, at `t`. Beyond the box: as dense as anywhere, for ever.
    MajorantStep at(const GridLine& line, double t) const;
    size_t bytes() const { return majorants_.capacity() * sizeof(float); }

  private:
    MajorantGrid(const Box3d& box, int cells);

    Box3d box_;
    int cells_;
    Vec3d width_, per_width_;       ///< of a cell; the reciprocal, 0 along sides without length
    std::vector<float> majorants_;  ///< x fastest
    float largest_ = 0;
};

}  // namespace rayleaf
