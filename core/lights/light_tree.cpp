#include "lights/light_tree.h"

#include <algorithm>
#include <numbers>
#include <numeric>
#include <span>

namespace rayleaf {

namespace {

/// Of all those lights.
LightCone common_cone(const std::vector<LightTreeItem>& items, std::span<const uint32_t> of) {
    LightCone result{Vec3f(0.0f), 1.0f, false, false};
    Vec3d sum(0.0);
    bool all_have_axes = true;
    for (const uint32_t item : of) {
        const LightCone& cone = items[item].cone;
        result.ahead |= cone.ahead;
        result.back |= cone.back;
        result.body.extendBy(cone.body);
        all_have_axes &= cone.axis != Vec3f(0.0f);
        sum += Vec3d(cone.axis) * items[item].intensity;
    }
    const double length = sum.length();
    if (!all_have_axes || !(length > 0.0)) return result;
    result.axis = Vec3f(sum / length);
    double widest = 0.0;
    for (const uint32_t item : of) {
        const LightCone& cone = items[item].cone;
        const float between = std::clamp(result.axis.dot(cone.axis), -1.0f, 1.0f);
        widest = std::max(widest, std::acos(double{between}) + std::acos(double{std::clamp(cone.cosine, -1.0f, 1.0f)}));
    }
    result.cosine = static_cast<float>(std::cos(std::min(widest, std::numbers::pi)));
    return result;
}

}  // namespace

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
    nodes_[node].radius = static_cast<float>(std::sqrt(nodes_[node].radius_squared));
    nodes_[node].intensity = intensity;
    set_cone(nodes_[node], common_cone(items, {order.data() + begin, end - begin}));
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

void LightTree::set_cone(Node& node, const LightCone& cone) {
    node.axis = cone.axis;
    node.spread = HalfAngle::of_cosine(std::clamp(cone.cosine, -1.0f, 1.0f));
    node.ahead = cone.ahead;
    if (cone.ahead && cone.back) return;
    node.body = static_cast<int32_t>(bodies_.size());
    bodies_.push_back(cone.body);
}

void LightTree::gather_sets(const std::vector<LightTreeItem>& items) {
    if (std::ranges::all_of(items, [](const LightTreeItem& item) { return item.set == kLightsOfAll; })) return;
    sets_.resize(nodes_.size());
    for (size_t i = nodes_.size(); i-- > 0;) {  // children come after their parents
        if (nodes_[i].left == 0) sets_[i] = items[nodes_[i].item].set;
        if (i > 0) sets_[nodes_[i].parent] |= sets_[i];
    }
}

LightGroups::Weight LightTree::weight(const LitPoint& at) const {
    if (nodes_.empty()) return {};
    const Node& root = nodes_.front();
    const View view(root, at.position);
    if (view.is_inside) return {mean_cosine(at), irradiance(0, at, 0)};
    const float cosine = cosine_at_surface(at.normal, view.direction, view.cone);
    return {cosine, root.intensity * (cosine * at_light(root, at, view)) * view.falloff};
}

/// Of a node around the point, by its children.
double LightTree::irradiance(size_t index, const LitPoint& at, int depth) const {
    constexpr int kDeepest = 3;
    const auto reaches_all = [](uint32_t) { return true; };
    const Node& node = nodes_[index];
    const bool around = (node.center - at.position).length2() <= node.radius_squared;
    if (!around) return importance(index, at, reaches_all);
    if (node.left == 0 || depth == kDeepest) return importance(index, at, reaches_all) * mean_cosine(at);
    return irradiance(node.left, at, depth + 1) + irradiance(size_t{node.left} + 1, at, depth + 1);
}

LightTree::Light LightTree::light(uint32_t item) const {
    const uint32_t index = leaf_of_item_[item];
    const Node& node = nodes_[index];
    return {node.center, std::sqrt(node.radius_squared), node.intensity, sets_.empty() ? kLightsOfAll : sets_[index]};
}

size_t LightTree::bytes() const {
    return nodes_.capacity() * sizeof(Node) + leaf_of_item_.capacity() * sizeof(uint32_t) +
           bodies_.capacity() * sizeof(Box3d) + sets_.capacity() * sizeof(LightSets);
}

}  // namespace rayleaf
