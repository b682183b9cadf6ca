#include "scene/grouped_boxes.h"

#include <algorithm>

namespace rayleaf {
namespace {

/// Things between two looks at the cancel token: well under a millisecond.
constexpr uint32_t kThingsPerLook = 4096;

}  // namespace

GroupedBoxes::GroupedBoxes(uint32_t count, const BoxOf& box_of, const CancelToken& cancel) : count_(count) {
    if (count == 0) return;
    std::vector<Box3d> boxes((count + kGroup - 1) / kGroup);
    for (uint32_t thing = 0; thing < count; ++thing) {
        if (thing % kThingsPerLook == 0) cancel.throw_if_cancelled();
        boxes[thing / kGroup].extendBy(box_of(thing));
    }
    levels_.push_back(std::move(boxes));
    while (levels_.back().size() > 1) {
        const std::vector<Box3d>& below = levels_.back();
        std::vector<Box3d> above((below.size() + kGroup - 1) / kGroup);
        for (size_t i = 0; i < below.size(); ++i) above[i / kGroup].extendBy(below[i]);
        levels_.push_back(std::move(above));
    }
}

bool GroupedBoxes::any(const Box3d& box, const Test& test) const {
    return !levels_.empty() && any_below(levels_.size() - 1, 0, box, test);
}

bool GroupedBoxes::any_below(size_t level, uint32_t group, const Box3d& box, const Test& test) const {
    if (!levels_[level][group].intersects(box)) return false;
    const auto end_of = [&](size_t count) { return std::min<size_t>(count, (size_t{group} + 1) * kGroup); };
    const size_t end = end_of(level == 0 ? count_ : levels_[level - 1].size());
    for (auto i = group * kGroup; i < end; ++i)
        if (level == 0 ? test(i) : any_below(level - 1, i, box, test)) return true;
    return false;
}

}  // namespace rayleaf
