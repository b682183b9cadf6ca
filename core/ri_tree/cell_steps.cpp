#include "ri_tree/cell_steps.h"

#include <algorithm>

namespace rayleaf {
CellSteps::CellSteps(const LineSpace& space, const RayCacheSettings& settings)
    : rays_per_cell_(static_cast<float>(settings.rays_per_cell)) {
    if (space.box().isEmpty()) return;
    deepest_ = settings.depth_limit / kStepDepths;
    for (int axis = 0; axis < 3; ++axis) {
        const auto direction = static_cast<uint8_t>(2 * axis);
        const std::array<double, kLineAxes> half_sides = space.root_half_sides(axis);
        for (size_t i = 0; i < steps_[axis].size(); ++i) {
            Step& step = steps_[axis][i];
            const int depth = static_cast<int>(i) * kStepDepths;
            step.levels = space.levels(direction, depth);
            // The centres of cells are lattice points too.
            if (*std::max_element(step.levels.begin(), step.levels.end()) >= kPlaceBits)
                deepest_ = std::min(deepest_, static_cast<int>(i) - 1);
            for (int k = 0; k < kLineAxes; ++k)
                step.inverse_sides[k] = static_cast<float>(std::ldexp(0.5 / half_sides[k], step.levels[k]));
            for (int j = 0; j < kStepDepths && depth + j < kGreatestCellDepth; ++j) {
                step.axis[j] = static_cast<uint8_t>(space.split_axis(direction, depth + j));
                const int level = space.levels(direction, depth + j)[step.axis[j]];
                step.bit[j] = static_cast<uint8_t>(std::max(kPlaceBits - 1 - level, 0));
            }
        }
    }
    deepest_mixed_ = std::min(deepest_, settings.mixed_depth_limit / kStepDepths);
}

/// Along each of the two axes beside the dominant one, neighbours lie `distance` and `angle` apart, on a slanted line
/// in the plane of intercept and slope. On average, 1 / (distance / side + angle / other side) rays of that line are
/// in one cell.
int CellSteps::deepest_crossed(uint8_t direction, const RaySpacing& spacing, int near) const {
    const float distance = std::abs(spacing.distance), angle = std::abs(spacing.angle);
    const auto is_worth = [&](int step) {
        const std::array<float, kLineAxes>& inverse = steps_[direction / 2][step].inverse_sides;
        const float b = distance * inverse[0] + angle * inverse[2];
        const float c = distance * inverse[1] + angle * inverse[3];
        return b * c * rays_per_cell_ <= 1.0f;
    };
    int step = std::max(near, 0);
    while (step >= 0 && !is_worth(step)) --step;
    while (step < deepest_ && is_worth(step + 1)) ++step;
    return step;
}

CellKey CellSteps::key(uint8_t direction, int step, const LinePlaces& places) const {
    CellKey key;
    key.direction = direction;
    key.depth = static_cast<uint8_t>(step * kStepDepths);
    for (int k = 0; k < kLineAxes; ++k) key.index[k] = places[k] >> (kPlaceBits - step_of(key).levels[k]);
    return key;
}

LinePlaces CellSteps::first_places(const CellKey& key) const {
    LinePlaces places{};
    for (int k = 0; k < kLineAxes; ++k) places[k] = key.index[k] << (kPlaceBits - step_of(key).levels[k]);
    return places;
}

CellPlace CellSteps::place(const CellKey& key) const {
    const LinePlaces first = first_places(key);
    CellPlace place;
    for (int k = 0; k < kLineAxes; ++k) {
        place.first[k] = static_cast<int32_t>(first[k]);
        place.bits[k] = kPlaceBits - step_of(key).levels[k];
    }
    return place;
}

LatticePoint CellSteps::sample_point(const CellKey& key, int sample) const {
    LatticePoint point;
    point.direction = key.direction;
    for (int k = 0; k < kLineAxes; ++k) {
        const uint32_t half_steps = sample == kCenterSample ? 1 : 2 * (static_cast<uint32_t>(sample) >> k & 1);
        point.place[k] = (2 * key.index[k] + half_steps) << (kPlaceBits - 1 - step_of(key).levels[k]);
    }
    return point;
}

}  // namespace rayleaf
