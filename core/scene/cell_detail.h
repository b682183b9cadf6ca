// How dense a medium is within a cell of its grid: what is found at points of the cell, and roughly between them.
//
// Tracking corrects what this gets wrong, so it may be rough: a byte a point, trilinear between them, and the same
// along each piece of a ray.
#pragma once

#include "scene/density_bounds.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace rayleaf {

/// Pieces of a ray in a cell, at most.
inline constexpr size_t kMostPieces = 8;

/// A ray in a cell, in pieces of the same length.
struct PiecesOfCell {
    /// In steps between points, from the cell's corner: where the first piece begins, and what leads to the next.
    std::array<float, 3> begin, step;
    alignas(32) std::array<float, kMostPieces> shares;  ///< in the middle of each, as CellDetail's
};

class CellDetail {
  public:
    /// Between points along a side of the cell; the points on its sides are its neighbours', too.
    static constexpr int kSteps = 3, kSide = kSteps + 1;
    static constexpr size_t kPoints = static_cast<size_t>(kSide) * kSide * kSide;

    /// None.
    CellDetail() = default;
    /// By what is found at its points, x fastest. None where that says little more than `cell`.
    CellDetail(std::span<const FoundDensity, kPoints> found, const DensityBounds& cell);

    bool is_none() const { return !(residual_ >= 0.0f); }
    float residual() const { return residual_; }
    /// Sets `shares`: of the way from the least density to the most, times 255. Of pieces beyond the cell's end any.
    void look_up(PiecesOfCell& pieces) const;
    /// Of a piece with that share. `cell`: as for the constructor.
    DensityBounds bounds(const DensityBounds& cell, float share) const;

  private:
    std::array<uint8_t, kPoints> shares_{};  // First: reading a row goes up to two bytes beyond them.
    float least_ = 0, per_share_ = 0;        ///< density over the cell's mean
    float residual_ = -1;                    ///< how far extinctions are from that, hardly ever more; negative: none
    bool scatters_ = false;                  ///< wherever it is dense
};

}  // namespace rayleaf
