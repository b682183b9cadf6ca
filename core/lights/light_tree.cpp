#include "lights/light_tree.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <numeric>

#include <tbb/parallel_for.h>

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

/// Lights that are half as long as all together: a node holds them and no others. Whoever is near is inside of it,
/// where the distance says nothing; small lights beside them would hardly be chosen, however near.
constexpr double kLargeSquared = 0.25;

/// Some lights, by what makes the estimate for all of them together a bad one for a single one.
struct LightCluster {
    Box3d box;
    double intensity = 0;
    Vec3d axes{0, 0, 0};  ///< of their cones, each times the intensity
    size_t count = 0;

    void add(const LightTreeItem& item) {
        box.extendBy(item.bounds);
        intensity += item.intensity;
        axes += Vec3d(item.cone.axis) * item.intensity;
        ++count;
    }
    void add(const LightCluster& other) {
        if (other.count == 0) return;
        box.extendBy(other.box);
        intensity += other.intensity;
        axes += other.axes;
        count += other.count;
    }
    /// Intensity, times how large, times how differently directed: lights that all shine one way fill a quarter of the
    /// directions that lights of all ways do.
    double cost() const {
        if (count < 2) return 0.0;
        const double alike = intensity > 0.0 ? axes.length() / intensity : 0.0;
        return intensity * box.size().length2() * (4.0 - 3.0 * alike);
    }
};

/// Where a node's lights are divided: at one of some even steps along an axis, so that the costs of both halves are
/// least (Conty Estevez and Kulla, section 4.4, with the square of the box's diagonal as its size).
class Division {
  public:
    Division(const std::vector<LightTreeItem>& items, std::span<const uint32_t> order, const Box3d& centers)
        : items_(items), centers_(centers) {
        std::array<std::array<LightCluster, kSteps>, 3> clusters;
        for (const uint32_t item : order)
            for (int axis = 0; axis < 3; ++axis) clusters[axis][step(item, axis)].add(items[item]);
        double least = std::numeric_limits<double>::infinity();
        for (int axis = 0; axis < 3; ++axis) {
            std::array<double, kSteps> cost_above{};
            LightCluster above, below;
            for (size_t i = kSteps; i-- > 1;) {
                above.add(clusters[axis][i]);
                cost_above[i] = above.cost();
            }
            for (size_t i = 1; i < kSteps; ++i) {
                below.add(clusters[axis][i - 1]);
                const double cost = below.cost() + cost_above[i];
                if (below.count == 0 || below.count == order.size() || !(cost < least)) continue;
                least = cost;
                axis_ = axis;
                first_above_ = i;
            }
        }
    }
    /// False where all lights have one middle.
    explicit operator bool() const { return first_above_ > 0; }
    bool is_below(uint32_t item) const { return step(item, axis_) < first_above_; }

  private:
    static constexpr size_t kSteps = 12;
    const std::vector<LightTreeItem>& items_;
    const Box3d& centers_;
    int axis_ = 0;
    size_t first_above_ = 0;

    size_t step(uint32_t item, int axis) const {
        const double extent = centers_.max[axis] - centers_.min[axis];
        if (!(extent > 0.0)) return 0;
        const double share = (items_[item].bounds.center()[axis] - centers_.min[axis]) / extent;
        return static_cast<size_t>(std::clamp(share * kSteps, 0.0, kSteps - 1.0));
    }
};

/// Orders the items of a node into those of its two children; how many the first has. `box` and `centers` are bounds of
/// the items and of their middles, `depth` is the node's.
size_t divide(const std::vector<LightTreeItem>& items, std::span<uint32_t> order, const Box3d& box,
              const Box3d& centers, int depth) {
    const auto below = [&](auto&& is_first) {
        return static_cast<size_t>(std::partition(order.begin(), order.end(), is_first) - order.begin());
    };
    const double large = kLargeSquared * box.size().length2();
    const size_t others = below([&](uint32_t item) { return items[item].bounds.size().length2() > large; });
    if (others > 0 && others < order.size()) return others;
    constexpr int kDeepest = 64;  // below it halves: no chain of lights gets too deep for a call in each
    if (const Division division(items, order, centers); division && depth < kDeepest)
        return below([&](uint32_t item) { return division.is_below(item); });
    return order.size() / 2;
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
    build(items, order, {0, order.size(), 0, 0}, cones, cancel);
    radius_ = static_cast<float>(std::sqrt(nodes_.front().radius_squared));
    gather_sets(items);
    add_branch(0, {}, items, cones, cancel);
}

void LightTree::build(const std::vector<LightTreeItem>& items, std::vector<uint32_t>& order, const Part& part,
                      std::vector<LightCone>& cones, const CancelToken& cancel) {
    cancel.throw_if_cancelled();
    const auto [begin, end, node, depth] = part;
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
    const size_t middle = begin + divide(items, {order.data() + begin, end - begin}, box, centers, depth);
    const auto left = static_cast<uint32_t>(nodes_.size());
    nodes_.resize(nodes_.size() + 2);
    nodes_[node].left = left;
    build(items, order, {begin, middle, left, depth + 1}, cones, cancel);
    build(items, order, {middle, end, left + 1, depth + 1}, cones, cancel);
}

void LightTree::add_branch(uint32_t node, const Place& parent, const std::vector<LightTreeItem>& items,
                           std::span<const LightCone> cones, const CancelToken& cancel) {
    cancel.throw_if_cancelled();
    constexpr float kLeastShare = 1e-30f;  // no light is left out
    const auto index = static_cast<uint32_t>(branches_.size());
    LightBranch& branch = branches_.emplace_back();
    branch.parent = parent.branch;
    branch.lane_of_parent = parent.lane;
    branch.count = children(node, branch.node);
    for (uint32_t i = 0; i < branch.count; ++i) {
        const Node& child = nodes_[branch.node[i]];
        const LightCone& cone = cones[branch.node[i]];
        branch.x[i] = child.center.x;
        branch.y[i] = child.center.y;
        branch.z[i] = child.center.z;
        branch.radius[i] = static_cast<float>(std::sqrt(child.radius_squared));
        branch.intensity[i] = std::max(kLeastShare, static_cast<float>(child.intensity / nodes_.front().intensity));
        branch.set_cone(i, cone);
        const bool has_body = branch.side[i] != 0.0f;
        if (has_body && (bodies_.empty() || bodies_.back() != cone.body)) bodies_.push_back(cone.body);
        branch.body[i] = has_body ? static_cast<int32_t>(bodies_.size()) - 1 : -1;
        branch.has_bodies |= branch.body[i] >= 0;
        if (child.left != 0) continue;
        branch.below[i] = child.item;
        branch.leaves |= 1u << i;
        if (items[child.item].bounded) branch.bounded |= 1u << i;
        place_of_item_[child.item] = {index, i};
    }
    for (uint32_t i = 0; i < branches_[index].count; ++i) {
        if (branches_[index].is_leaf(i)) continue;
        branches_[index].below[i] = static_cast<uint32_t>(branches_.size());
        add_branch(branches_[index].node[i], {index, i}, items, cones, cancel);
    }
}

/// Those that are weighed together below a node, or a leaf alone; their number. Of the nodes that may be replaced by
/// their children those are whose estimate is the worst.
uint32_t LightTree::children(uint32_t node, std::array<uint32_t, LightBranch::kMost>& result) const {
    uint32_t count = 0;
    result[count++] = node;
    while (count < LightBranch::kMost) {
        uint32_t worst = count;
        double most = -1.0;
        for (uint32_t i = 0; i < count; ++i) {
            const Node& each = nodes_[result[i]];
            const double error = each.intensity * each.radius_squared;
            if (each.left == 0 || !(error > most)) continue;
            worst = i;
            most = error;
        }
        if (worst == count) break;
        const uint32_t left = nodes_[result[worst]].left;
        result[worst] = left;
        result[count++] = left + 1;
    }
    return count;
}

void LightTree::gather_sets(const std::vector<LightTreeItem>& items) {
    if (std::ranges::all_of(items, [](const LightTreeItem& item) { return item.set == kLightsOfAll; })) return;
    sets_.resize(nodes_.size());
    for (size_t i = nodes_.size(); i-- > 0;) {  // children come after their parents
        if (nodes_[i].left == 0) sets_[i] = items[nodes_[i].item].set;
        if (nodes_[i].left != 0) sets_[i] = sets_[nodes_[i].left] | sets_[nodes_[i].left + 1];
    }
}

/// One of the lights of a node, by a number in [0,1).
uint32_t LightTree::item_below(uint32_t node, double choice) const {
    while (nodes_[node].left != 0) {
        const uint32_t left = nodes_[node].left;
        const double both = nodes_[left].intensity + nodes_[left + 1].intensity;
        const double share = both > 0.0 ? nodes_[left].intensity / both : 0.5;
        const bool first = choice < share;
        choice = first ? choice / share : (choice - share) / (1.0 - share);
        node = first ? left : left + 1;
    }
    return nodes_[node].item;
}

LightView LightTree::view_of(uint32_t node, const Look& look) const {
    constexpr double kGolden = 0.6180339887498949;
    LightView result;
    double choice = 0.5;  // of the lights of a node each ray takes another
    for (size_t cell = 0; cell < LightView::kCells; ++cell)
        for (size_t ray = 0; ray < LightView::kRays; ++ray) {
            choice += kGolden;
            choice -= std::floor(choice);
            const Place& place = place_of_item_[item_below(node, choice)];
            const LightBranch& branch = branches_[place.branch];
            const Vec3d center(branch.x[place.lane], branch.y[place.lane], branch.z[place.lane]);
            const Vec3d direction = LightView::direction(cell, ray);
            if (const std::optional<Obstacle> met = look(center, direction))
                result.set(cell, ray, met->normal, center + direction * met->distance - nodes_[node].center);
        }
    return result;
}

void LightTree::look_around(const Look& look, const CancelToken& cancel) {
    if (nodes_.empty() || is_single()) return;
    const auto see_from = [&](LightBranch& branch) {
        std::array<LightView, LightBranch::kMost> views;
        tbb::parallel_for(uint32_t{0}, branch.count, [&](uint32_t lane) {
            cancel.throw_if_cancelled();
            views[lane] = view_of(branch.node[lane], look);
        });
        for (uint32_t lane = 0; lane < branch.count; ++lane) {
            if (views[lane].is_open()) continue;
            branch.view[lane] = static_cast<int32_t>(views_.size());
            branch.has_views = true;
            views_.push_back(views[lane]);
        }
    };
    see_from(branches_.front());
    for (uint32_t lane = 0; lane < branches_.front().count; ++lane)
        if (!branches_.front().is_leaf(lane)) see_from(branches_[branches_.front().below[lane]]);
}

void LightTree::see(const LightBranch& branch, const LitPoint& at, LightBranch::Weights& weights) const {
    constexpr float kLeastOfAll = 0.02f;  // with less nodes are hardly chosen anyway
    constexpr float kNearest = 9.0f;      // squared distance in radii; nearer, the lights of a node see other things
    const float least = kLeastOfAll * sum_of(weights.numbers);
    for (size_t lane = 0; lane < branch.count; ++lane) {
        if (branch.view[lane] < 0 || !(weights.numbers[lane] > least)) continue;
        const Vec3f offset(at.position - Vec3d(branch.x[lane], branch.y[lane], branch.z[lane]));
        if (offset.length2() <= kNearest * branch.radius[lane] * branch.radius[lane]) continue;
        const float share = views_[static_cast<size_t>(branch.view[lane])].share(offset);
        weights.numbers[lane] *= share;
        weights.cosines[lane] *= share;
    }
}

/// At best, of all lights.
float LightTree::cosine_at(const LitPoint& at) const {
    const Vec3f offset(nodes_.front().center - at.position);
    const float distance_squared = offset.length2(), beyond = distance_squared - radius_ * radius_;
    if (!(beyond > 0.0f)) return static_cast<float>(mean_cosine(at));
    if (at.normal == Vec3f(0.0f)) return 1.0f;
    // As cosine_at_surface, with cosines and sines times the distance.
    const float cosine = offset.dot(at.normal), of_cone = std::sqrt(beyond);
    if (cosine >= of_cone) return 1.0f;
    const float sine = std::sqrt(std::max(0.0f, distance_squared - cosine * cosine));
    return std::max(kLeastCosine, (cosine * of_cone + sine * radius_) / distance_squared);
}

Float4 LightTree::sides(const LightBranch& branch, const LitPoint& at) const {
    Float4 result = branch.side;
    int32_t last = -1;
    bool is_within = false;  // the last body
    for (size_t i = 0; i < branch.count; ++i) {
        if (branch.body[i] < 0) continue;
        if (branch.body[i] != last) is_within = bodies_[static_cast<size_t>(branch.body[i])].intersects(at.position);
        last = branch.body[i];
        if (is_within) result[i] = 0.0f;
    }
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
           sets_.capacity() * sizeof(LightSets) + views_.capacity() * sizeof(LightView);
}

}  // namespace rayleaf
