// How dense a medium that varies is, cell by cell: at most, on average, and how far from that. Null collisions go by
// the first (Woodcock et al. 1965), estimates of transmittance by the others (Novak et al. 2014).
//
// It is looked up at points of a lattice, with some reserve. Where a medium is denser between them, it is rendered as
// dense as its bound (integrators/medium_tracking.cpp).
#pragma once

#include "base/cancel.h"
#include "base/vector.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <span>
#include <vector>

namespace rayleaf {

/// What is found at a point.
struct FoundDensity {
    Color extinction{0, 0, 0};  ///< per world unit
    float lookups = 0;          ///< per world unit, at least: 0 but where there is nothing but light
    bool scatters = false;
};

/// Of a cell, per world unit. Not initialized: rays hold many.
struct DensityBounds {
    float majorant;  ///< extinction of the densest channel, at most
    float certain;   ///< of the thinnest, hardly ever less; 0 where it may not scatter
    float residual;  ///< how far the extinction of any channel is from `mean`, at most
    Color mean;      ///< extinction

    static DensityBounds none() { return {0.0f, 0.0f, 0.0f, Color(0.0f)}; }
    DensityBounds& operator+=(const DensityBounds& other);
};

/// Of points that stand for a cell: `shown` for its mean, and `reserve` > 1 for what lies between all of them.
DensityBounds bounds_of(std::span<const FoundDensity> all, std::span<const FoundDensity> shown, float reserve);

/// A ray in a grid's space.
struct GridLine {
    Vec3d origin, direction, per_direction;  ///< the last: reciprocals, 0 where there are none

    GridLine() = default;
    GridLine(const Vec3d& from, const Vec3d& towards);
};

class MajorantGrid {
  public:
    /// At points of the grid's own space; up to kMostPoints at once (shading/program.h).
    using Lookup = std::function<void(std::span<const Vec3d> points, FoundDensity* found)>;

    /// `cells` along each side of `box`. Throws Cancelled soon after `cancel` says so.
    MajorantGrid(const Box3d& box, int cells, const Lookup& lookup, const CancelToken& cancel);

    /// Of bounds that are known, x fastest.
    MajorantGrid(const Box3d& box, int cells, std::vector<DensityBounds> bounds);

    size_t bytes() const { return bounds_.capacity() * sizeof(DensityBounds); }

  private:
    friend class GridWalk;

    MajorantGrid(const Box3d& box, int cells);
    void note_largest();

    Box3d box_;
    int cells_;
    Vec3d width_, per_width_;                        ///< of a cell; the reciprocal, 0 along sides without length
    std::vector<DensityBounds> bounds_;              ///< x fastest
    DensityBounds largest_ = DensityBounds::none();  ///< what holds everywhere
};

/// The cells along a ray, from its origin, one after the other. Beyond the box: as dense as anywhere, for ever.
class GridWalk {
  public:
    GridWalk() = default;
    GridWalk(const MajorantGrid& grid, const GridLine& line);

    const DensityBounds& bounds() const { return *bounds_; }
    double end() const { return end_; }  ///< how far along the ray they hold
    void advance();

  private:
    /// Along one axis. The border of cell c is met at `base + step * c`.
    struct Axis {
        double base = 0, step = 0;
        double border = std::numeric_limits<double>::infinity();  ///< where the walk leaves its cell
        int next = 0, last = 0;  ///< number of that border; of the last inside the grid, in the walk's direction
        int turn = 1;            ///< to the next
        std::ptrdiff_t stride = 0;

        void find_border() { border = std::max(base + step * next, 0.0); }
    };
    std::array<Axis, 3> axes_;
    const DensityBounds* bounds_ = nullptr;
    const DensityBounds* beyond_ = nullptr;
    double end_ = std::numeric_limits<double>::infinity();

    void find_end() { end_ = std::min({axes_[0].border, axes_[1].border, axes_[2].border}); }
};

}  // namespace rayleaf
