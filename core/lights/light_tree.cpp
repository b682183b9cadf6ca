#include "lights/light_tree.h"

#include <algorithm>
#include <numeric>

namespace rayleaf {

LightTree::LightTree(const std::vector<LightTreeItem>& items, const CancelToken& cancel) : leaf_of_item_(items.size()) {
    if (items.empty()) return;
    std::vector<uint32_t> order(items.size());
    std::iota(order.begin(), order.end(), 0u);
    nodes_.reserve(2 * items.size() - 1);
    nodes_.emplace_back();
    build(items, order, 0, order.size(), 0, cancel);
    gather_sets(items);
}

void LightTree::build(const std::vector<LightTreeItem>& items, std::vector<uint32_t>& order, size_t begin, size_t end,
                      uint32_t node, const CancelToken& cancel) {
    cancel.throw_if_cancelled();
    Box3d box, centers;
    double intensity = 0;
    for (size_t i = begin; i < end; ++i) {
        box.extendBy(items[order[i]].bounds);
        centers.extendBy(items[order[i]].bounds.center());
        intensity += items[order[i]].intensity;
    }
    nodes_[node].center = box.center();
    nodes_[node].radius_squared = 0.25 * box.size().length2();
    nodes_[node].intensity = intensity;
    if (end - begin == 1) {
        nodes_[node].item = order[begin];
        leaf_of_item_[order[begin]] = node;
        return;
    }
    const auto axis = static_cast<int>(centers.majorAxis());
    const size_t middle = begin + (end - begin) / 2;
    const auto center_of = [&](uint32_t item) { return items[item].bounds.min[axis] + items[item].bounds.max[axis]; };
    std::nth_element(order.begin() + static_cast<ptrdiff_t>(begin), order.begin() + static_cast<ptrdiff_t>(middle),
                     order.begin() + static_cast<ptrdiff_t>(end), [&](uint32_t a, uint32_t b) {
                         return center_of(a) != center_of(b) ? center_of(a) < center_of(b) : a < b;
                     });
    const auto left = static_cast<uint32_t>(nodes_.size());
    nodes_.resize(nodes_.size() + 2);
    nodes_[node].left = left;
    nodes_[left].parent = nodes_[left + 1].parent = node;
    build(items, order, begin, middle, left, cancel);
    build(items, order, middle, end, left + 1, cancel);
}

void LightTree::gather_sets(const std::vector<LightTreeItem>& items) {
    if (std::ranges::all_of(items, [](const LightTreeItem& item) { return item.set == kLightsOfAll; })) return;
    sets_.resize(nodes_.size());
    for (size_t i = nodes_.size(); i-- > 0;) {  // children come after their parents
        if (nodes_[i].left == 0) sets_[i] = items[nodes_[i].item].set;
        if (i > 0) sets_[nodes_[i].parent] |= sets_[i];
    }
}

double LightTree::irradiance(const LitPoint& at) const {
    if (nodes_.empty()) return 0;
    return importance(0, at, [](uint32_t) { return true; });
}

LightTree::Light LightTree::light(uint32_t item) const {
    const uint32_t index = leaf_of_item_[item];
    const Node& node = nodes_[index];
    return {node.center, std::sqrt(node.radius_squared), node.intensity, sets_.empty() ? kLightsOfAll : sets_[index]};
}

size_t LightTree::bytes() const {
    return nodes_.capacity() * sizeof(Node) + leaf_of_item_.capacity() * sizeof(uint32_t) +
           sets_.capacity() * sizeof(LightSets);
}

}  // namespace rayleaf
