// The depths at which the fast tree tests cells, counted by fours: where cells lie in the lattice, and which of them a
// frame's rays pay for.
#pragma once

#include "ri_tree/cell_judge.h"
#include "ri_tree/fast_sample.h"
#include "ri_tree/line_batch.h"
#include "ri_tree/line_space.h"

#include <array>
#include <cstdint>

namespace rayleaf {

/// Halvings between two tests.
inline constexpr int kStepDepths = 4;
/// A line's place along each axis, times 2^kPlaceBits.
using LinePlaces = std::array<uint32_t, kLineAxes>;

class CellSteps {
  public:
    CellSteps(const LineSpace& space, const RayCacheSettings& settings);

    /// The smallest cells, as a step.
    int deepest() const { return deepest_; }
    CellDepths depths(int step) const { return {step >= deepest_, step >= deepest_mixed_}; }
    /// The smallest cells that enough neighbours of a ray cross, as a step; -1: none. `spacing` is in local units.
    /// Smaller cells are worth less, so the search may begin anywhere: `near`, the answer for a neighbour.
    int deepest_worth(uint8_t direction, const RaySpacing& spacing, int near) const;

    /// Which of a cell's sixteen children holds a line.
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
        /// How the child is found that holds a place: bit j of its number is this bit of the place along this axis.
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
