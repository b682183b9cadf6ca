#include "lights/light_tree.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <numeric>

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

LightTree::LightTree(const std::vector<LightTreeItem>& items, const CancelToken& cancel)
    : place_of_item_(items.size()) {
    if (items.empty()) return;
    std::vector<uint32_t> order(items.size());
    std::iota(order.begin(), order.end(), 0u);
    nodes_.reserve(2 * items.size() - 1);
    nodes_.emplace_back();
    std::vector<LightCone> cones(2 * items.size() - 1);
    build(items, order, 0, order.size(), 0, cones, cancel);
    gather_sets(items);
    add_branch(std::array{uint32_t{0}}, {}, cones);
}

void LightTree::build(const std::vector<LightTreeItem>& items, std::vector<uint32_t>& order, size_t begin, size_t end,
                      uint32_t node, std::vector<LightCone>& cones, const CancelToken& cancel) {
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
    cones[node] = common_cone(items, {order.data() + begin, end - begin});
    if (end - begin == 1) {
        nodes_[node].item = order[begin];
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
    build(items, order, begin, middle, left, cones, cancel);
    build(items, order, middle, end, left + 1, cones, cancel);
}

void LightTree::add_branch(std::span<const uint32_t> nodes, const Place& parent, std::span<const LightCone> cones) {
    constexpr float kLeastShare = 1e-30f;  // no light is left out
    const auto index = static_cast<uint32_t>(branches_.size());
    LightBranch& branch = branches_.emplace_back();
    branch.parent = parent.branch;
    branch.lane_of_parent = parent.lane;
    branch.count = static_cast<uint32_t>(nodes.size());
    for (uint32_t i = 0; i < nodes.size(); ++i) {
        const Node& node = nodes_[nodes[i]];
        const LightCone& cone = cones[nodes[i]];
        branch.node[i] = nodes[i];
        branch.x[i] = node.center.x;
        branch.y[i] = node.center.y;
        branch.z[i] = node.center.z;
        branch.radius[i] = static_cast<float>(std::sqrt(node.radius_squared));
        branch.intensity[i] = std::max(kLeastShare, static_cast<float>(node.intensity / nodes_.front().intensity));
        branch.set_cone(i, cone);
        branch.body[i] = branch.side[i] == 0.0f ? -1 : static_cast<int32_t>(bodies_.size());
        if (branch.body[i] >= 0) bodies_.push_back(cone.body);
        branch.has_bodies |= branch.body[i] >= 0;
        if (node.left == 0) branch.leaves |= 1u << i;
    }
    for (uint32_t i = 0; i < nodes.size(); ++i) {
        const Node& node = nodes_[nodes[i]];
        if (node.left == 0) {
            branches_[index].below[i] = node.item;
            place_of_item_[node.item] = {index, i};
            continue;
        }
        std::array<uint32_t, LightBranch::kMost> below;
        size_t count = 0;
        for (const uint32_t child : {node.left, node.left + 1}) {
            const uint32_t left = nodes_[child].left;
            below[count++] = left == 0 ? child : left;
            if (left != 0) below[count++] = left + 1;
        }
        branches_[index].below[i] = static_cast<uint32_t>(branches_.size());
        add_branch({below.data(), count}, {index, i}, cones);
    }
}

void LightTree::gather_sets(const std::vector<LightTreeItem>& items) {
    if (std::ranges::all_of(items, [](const LightTreeItem& item) { return item.set == kLightsOfAll; })) return;
    sets_.resize(nodes_.size());
    for (size_t i = nodes_.size(); i-- > 0;) {  // children come after their parents
        if (nodes_[i].left == 0) sets_[i] = items[nodes_[i].item].set;
        if (nodes_[i].left != 0) sets_[i] = sets_[nodes_[i].left] | sets_[nodes_[i].left + 1];
    }
}

LightGroups::Weight LightTree::weight(const LitPoint& at) const {
    if (nodes_.empty()) return {};
    const double irradiance = this->irradiance(branches_.front(), at, 0) * nodes_.front().intensity;
    const Node& root = nodes_.front();
    if (root.is_around(at.position)) return {mean_cosine(at), irradiance};
    const Vec3d offset = root.center - at.position;
    const double inverse = 1.0 / offset.length();
    const HalfAngle seen = HalfAngle::of_sine(static_cast<float>(std::sqrt(root.radius_squared) * inverse));
    return {cosine_at_surface(at.normal, Vec3f(offset * inverse), seen), irradiance};
}

/// Of a branch, as a share of the tree's intensity; of a node around the point, by its children.
double LightTree::irradiance(const LightBranch& branch, const LitPoint& at, int depth) const {
    constexpr int kDeepest = 2;
    const LightBranch::Lanes weights = this->weights(branch, at, [](uint32_t) { return true; });
    double sum = 0;
    for (size_t i = 0; i < branch.count; ++i) {
        if (!(weights[i] > 0.0f)) continue;
        if (!nodes_[branch.node[i]].is_around(at.position))
            sum += weights[i];
        else if (branch.is_leaf(i) || depth == kDeepest)
            sum += weights[i] * mean_cosine(at);
        else
            sum += irradiance(branches_[branch.below[i]], at, depth + 1);
    }
    return sum;
}

LightBranch::Lanes LightTree::sides(const LightBranch& branch, const LitPoint& at) const {
    LightBranch::Lanes result = branch.side;
    for (size_t i = 0; i < branch.count; ++i)
        if (branch.body[i] >= 0 && bodies_[static_cast<size_t>(branch.body[i])].intersects(at.position))
            result[i] = 0.0f;
    return result;
}

LightTree::Light LightTree::light(uint32_t item) const {
    const Place& place = place_of_item_[item];
    const uint32_t index = branches_[place.branch].node[place.lane];
    const Node& node = nodes_[index];
    return {node.center, std::sqrt(node.radius_squared), node.intensity, sets_.empty() ? kLightsOfAll : sets_[index]};
}

size_t LightTree::bytes() const {
    return nodes_.capacity() * sizeof(Node) + branches_.capacity() * sizeof(LightBranch) +
           place_of_item_.capacity() * sizeof(Place) + bodies_.capacity() * sizeof(Box3d) +
           sets_.capacity() * sizeof(LightSets);
}

}  // namespace rayleaf
