// The depths at which the fast tree tests cells: every fourth depth is a step. Says where cells lie in the lattice, and
// which of them enough of a frame's rays cross to be sampled.
#pragma once

#include "ri_tree/cell_judge.h"
#include "ri_tree/fast_sample.h"
#include "ri_tree/line_batch.h"
#include "ri_tree/line_space.h"

#include <array>
#include <cstdint>

namespace rayleaf {

/// Halvings from one step to the next.
inline constexpr int kStepDepths = 4;
/// A line's place along each axis, times 2^kPlaceBits.
using LinePlaces = std::array<uint32_t, kLineAxes>;

class CellSteps {
  public:
    CellSteps(const LineSpace& space, const RayCacheSettings& settings);

    /// The step of the smallest cells.
    int deepest() const { return deepest_; }
    CellDepths depths(int step) const { return {step >= deepest_, step >= deepest_mixed_}; }
    /// The step of the smallest cells that enough neighbours of a ray cross; -1: none. `spacing` is in local units.
    /// Fewer rays cross smaller cells, so the search may begin anywhere: at `near`, the answer for a neighbour.
    int deepest_crossed(uint8_t direction, const RaySpacing& spacing, int near) const;

    /// The number of the child, of a cell's sixteen, that holds a line.
    uint32_t child(uint8_t direction, int step, const LinePlaces& places) const {
        const Step& at = steps_[direction / 2][step];
        uint32_t number = 0;
        for (int j = 0; j < kStepDepths; ++j) number |= (places[at.axis[j]] >> at.bit[j] & 1u) << j;
        return number;
    }
    CellKey key(uint8_t direction, int step, const LinePlaces& places) const;
    LinePlaces first_places(const CellKey& key) const;
    CellPlace place(const CellKey& key) const;
    /// A corner, or the centre (kCenterSample).
    LatticePoint sample_point(const CellKey& key, int sample) const;

  private:
    struct Step {
        std::array<uint8_t, kLineAxes> levels{};
        /// Bit j of a child's number is bit `bit[j]` of the place along axis `axis[j]`.
        std::array<uint8_t, kStepDepths> axis{}, bit{};
        /// 1 over the sides: intercepts in local units, slopes.
        std::array<float, kLineAxes> inverse_sides{};
    };

    std::array<std::array<Step, kGreatestCellDepth / kStepDepths + 1>, 3> steps_;  ///< by dominant axis
    int deepest_ = 0, deepest_mixed_ = 0;
    float rays_per_cell_;

    const Step& step_of(const CellKey& key) const { return steps_[key.direction / 2][key.depth / kStepDepths]; }
};

}  // namespace rayleaf
