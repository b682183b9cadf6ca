// Choice of one of many lights: a binary tree whose nodes know the power and the place of the lights below them.
//
// A reduced light tree (A. Conty Estevez, C. Kulla: Importance Sampling of Many Lights with Adaptive Tree Splitting,
// HPG 2018, section 4): a node is chosen in proportion to intensity over squared distance, times the cosines at the
// lights (their orientation cones) and at the point; one of up to four, which are weighed together
// (lights/light_branch.h): those below the last whose estimates are the worst. Without the part of the paper that
// splits nodes; but large lights lie in nodes of their own, so that no node is large for one light's sake, and of the
// first choice a share goes by cosines alone. What stands around the lights of the first choices is known by few rays
// (lights/light_view.h). A single light may say that its light does not arrive. Cosines are means over a node, where
// the paper has bounds: bounds of neighbours differ little, and half of the samples would go to lights that face away.
// None counts as nothing. One light costs O(log n), and the choice is a pure function of the point and the random
// number.
#pragma once

#include "base/cancel.h"
#include "base/vector.h"
#include "lights/light_branch.h"
#include "lights/light_groups.h"
#include "lights/light_linking.h"
#include "lights/light_view.h"
#include "rays/ray.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace rayleaf {

/// A light as the tree sees it.
struct LightTreeItem {
    Box3d bounds;                  ///< world
    double intensity = 0;          ///< W/sr at best, positive
    LightSets set = kLightsOfAll;  ///< LightLink::set
    LightCone cone = {};
    bool bounded = false;  ///< it shines on a part of space alone
};

class LightTree {
  public:
    /// Throws Cancelled soon after `cancel` says so.
    explicit LightTree(const std::vector<LightTreeItem>& items, const CancelToken& cancel = kNeverCancelled);

    /// What a ray from a place meets: its distance, world units, and the unit normal on the ray's side.
    struct Obstacle {
        double distance = 0;
        Vec3d normal;
    };
    using Look = std::function<std::optional<Obstacle>(const Vec3d& from, const Vec3d& direction)>;
    /// Finds out what stands around the lights of the first choices.
    void look_around(const Look& look, const CancelToken& cancel);

    bool empty() const { return nodes_.empty(); }
    /// Of the lights among which the choice of one begins. All zero where none of them arrives.
    template <typename Reaches>
    Float4 first_weights(const LitPoint& at, const Reaches& reaches) const {
        return weights_of(branches_.front(), at, reaches).evened();
    }
    /// The tree's against suns and the world: the cosine at the point, at best, and a rough estimate of the irradiance
    /// of all lights there. `first`: first_weights.
    template <typename Reaches>
    LightGroups::Weight weight(const LitPoint& at, Float4 first, const Reaches& reaches) const;
    /// Whether any light shines on a point, by their links alone.
    bool shines_on(const LitPoint& at) const { return !nodes_.empty() && is_linked(0, at.lit_by); }

    struct Choice {
        uint32_t item = 0;
        double probability = 0;
        double left_over = 0;  ///< of the random number: again in [0,1)
    };
    /// `random` in [0,1). Empty where no light arrives. `reaches(item)` is asked of single lights that are bounded.
    /// `first`: by what the choice begins, like first_weights; where there is one light alone they are not asked for.
    template <typename Reaches>
    std::optional<Choice> choose(const LitPoint& at, double random, const Reaches& reaches, Float4 first) const;
    /// The probability with which `choose` returns `item`, which shines on the point.
    template <typename Reaches>
    double probability(const LitPoint& at, uint32_t item, const Reaches& reaches, Float4 first) const;

    struct Light {
        Vec3d center;
        double radius = 0;     ///< of the sphere about its box
        double intensity = 0;  ///< as it was given
        LightSets set = kLightsOfAll;
    };
    Light light(uint32_t item) const;
    size_t count() const { return place_of_item_.size(); }

    /// Calls `visit(item)` for every light that the first `end` of a ray may cross. That is told by the bounds of
    /// several lights: those of one take as long to ask as a light itself.
    template <typename Visit>
    void visit_crossed(const Ray& ray, double end, const Visit& visit) const {
        any_crossed(ray, end, [&visit](uint32_t item) {
            visit(item);
            return false;
        });
    }
    /// Whether `test(item)` holds for any of them.
    template <typename Test>
    bool any_crossed(const Ray& ray, double end, const Test& test) const {
        if (nodes_.empty()) return false;
        // Most rays come from places amid the lights and cross the bounds of all.
        return is_single() ? test(0) : any_crossed_below(nodes_.front(), ray, end, test);
    }

    /// Whether a ray crosses the sphere about the box of a light.
    bool is_crossed(uint32_t item, const Ray& ray) const {
        const Place& place = place_of_item_[item];
        return may_cross(nodes_[branches_[place.branch].node[place.lane]], ray,
                         std::numeric_limits<double>::infinity());
    }

    size_t bytes() const;

  private:
    struct Node {
        Vec3d center;
        double radius_squared = 0;  ///< of the sphere about the box
        double intensity = 0;
        uint32_t left = 0;  ///< the right child follows its left sibling; 0: a leaf
        uint32_t item = 0;  ///< of a leaf
    };
    struct Place {
        uint32_t branch = 0, lane = 0;
    };
    std::vector<Node> nodes_;
    std::vector<LightBranch> branches_;  ///< the first begins below the root
    std::vector<LightView> views_;       ///< of nodes that are not seen from everywhere
    std::vector<Place> place_of_item_;
    float radius_ = 0;  ///< of the root
    std::vector<Box3d> bodies_;
    std::vector<LightSets> sets_;  ///< per node, of all its lights; empty where all shine on all

    bool is_single() const { return nodes_.size() == 1; }
    bool is_linked(size_t node, LightSets lit_by) const { return sets_.empty() || (sets_[node] & lit_by) != 0; }
    float cosine_at(const LitPoint& at) const;
    template <typename Reaches>
    double irradiance(const LightBranch& branch, Float4 weights, const LitPoint& at, const Reaches& reaches,
                      int depth) const;
    void add_branch(uint32_t node, const Place& parent, const std::vector<LightTreeItem>& items,
                    std::span<const LightCone> cones, const CancelToken& cancel);
    uint32_t children(uint32_t node, std::array<uint32_t, LightBranch::kMost>& result) const;
    void gather_sets(const std::vector<LightTreeItem>& items);
    /// Items of `order` that belong to a node.
    struct Part {
        size_t begin, end;
        uint32_t node;
        int depth;
    };
    void build(const std::vector<LightTreeItem>& items, std::vector<uint32_t>& order, const Part& part,
               std::vector<LightCone>& cones, const CancelToken& cancel);

    template <typename Reaches>
    LightBranch::Weights weights_of(const LightBranch& branch, const LitPoint& at, const Reaches& reaches) const {
        Float4 shining = branch.intensity;
        for (uint32_t rest = branch.bounded; rest != 0; rest &= rest - 1) {
            const auto lane = static_cast<size_t>(std::countr_zero(rest));
            if (!reaches(branch.below[lane])) shining[lane] = 0.0f;
        }
        for (size_t i = 0; !sets_.empty() && i < branch.count; ++i)
            if (!is_linked(branch.node[i], at.lit_by)) shining[i] = 0.0f;
        LightBranch::Weights result = branch.weights(at, shining, branch.has_bodies ? sides(branch, at) : branch.side);
        if (branch.has_views) see(branch, at, result);
        return result;
    }
    /// Lessens the weights of nodes whose light does not seem to get to the point.
    void see(const LightBranch& branch, const LitPoint& at, LightBranch::Weights& weights) const;
    uint32_t item_below(uint32_t node, double choice) const;
    LightView view_of(uint32_t node, const Look& look) const;
    /// Those that are seen from the point.
    Float4 sides(const LightBranch& branch, const LitPoint& at) const;

    static bool may_cross(const Node& node, const Ray& ray, double end) {
        const Vec3d offset = node.center - ray.origin;
        const double nearest = std::max(0.0, std::min(offset.dot(ray.direction), end));
        // Rounding of the offset counts where lights are far smaller than their distance.
        const double slack = node.radius_squared * kRoundingShare + offset.length2() * kRounding;
        return !((offset - ray.direction * nearest).length2() > node.radius_squared + slack);
    }
    template <typename Test>
    bool any_crossed_below(const Node& node, const Ray& ray, double end, const Test& test) const {
        for (const Node* child = &nodes_[node.left]; child != &nodes_[node.left] + 2; ++child) {
            if (child->left == 0 ? test(child->item)
                                 : may_cross(*child, ray, end) && any_crossed_below(*child, ray, end, test))
                return true;
        }
        return false;
    }

    static constexpr double kRoundingShare = 1e-6;  ///< of a squared radius
    static constexpr double kRounding = 1e-24;  ///< of a squared distance: some thousand times its rounding, squared
};

template <typename Reaches>
LightGroups::Weight LightTree::weight(const LitPoint& at, Float4 first, const Reaches& reaches) const {
    const double irradiance = this->irradiance(branches_.front(), first, at, reaches, 0);
    return {cosine_at(at), irradiance * nodes_.front().intensity};
}

/// Of a branch, as a share of the tree's intensity; of a node around the point, by its children.
template <typename Reaches>
double LightTree::irradiance(const LightBranch& branch, Float4 weights, const LitPoint& at, const Reaches& reaches,
                             int depth) const {
    constexpr int kDeepest = 1;
    const uint32_t around = branch.around(at.position);
    double sum = 0;
    for (size_t i = 0; i < LightBranch::kMost; ++i) {
        if ((around >> i & 1u) == 0 || !(weights[i] > 0.0f)) {
            sum += double{weights[i]};
        } else if (branch.is_leaf(i) || depth == kDeepest) {
            sum += double{weights[i]} * mean_cosine(at);
        } else {
            const LightBranch& below = branches_[branch.below[i]];
            sum += irradiance(below, weights_of(below, at, reaches).numbers, at, reaches, depth + 1);
        }
    }
    return sum;
}

template <typename Reaches>
std::optional<LightTree::Choice> LightTree::choose(const LitPoint& at, double random, const Reaches& reaches,
                                                   Float4 first) const {
    if (!shines_on(at)) return std::nullopt;
    Choice choice{nodes_.front().item, 1.0, random};
    if (is_single()) return choice;
    const LightBranch* branch = branches_.data();
    Float4 weights = first;
    for (;;) {
        // Up to and with each one.
        const double to_0 = double{weights[0]}, to_1 = to_0 + double{weights[1]}, to_2 = to_1 + double{weights[2]},
                     total = to_2 + double{weights[3]};
        if (!(total > 0)) return std::nullopt;
        const double place = choice.left_over * total;  // less than all of it, as what is left over is less than 1
        const int lane = int{place >= to_0} + int{place >= to_1} + int{place >= to_2};
        const double begin = std::array{0.0, to_0, to_1, to_2}[static_cast<size_t>(lane)];
        const double weight = double{weights[lane]};
        choice.left_over = std::min((place - begin) / weight, 1.0 - 0x1p-53);
        choice.probability *= weight / total;
        choice.item = branch->below[static_cast<size_t>(lane)];
        if (branch->is_leaf(static_cast<size_t>(lane))) return choice;
        branch = &branches_[choice.item];
        weights = weights_of(*branch, at, reaches).numbers;
    }
}

template <typename Reaches>
double LightTree::probability(const LitPoint& at, uint32_t item, const Reaches& reaches, Float4 first) const {
    if (is_single()) return 1.0;
    double probability = 1.0;
    for (Place place = place_of_item_[item];;) {
        const LightBranch& branch = branches_[place.branch];
        const Float4 weights = place.branch > 0 ? weights_of(branch, at, reaches).numbers : first;
        const double total = double{weights[0]} + double{weights[1]} + double{weights[2]} + double{weights[3]};
        probability *= total > 0 ? double{weights[place.lane]} / total : 0.0;
        if (place.branch == 0) return probability;
        place = {branch.parent, branch.lane_of_parent};
    }
}

}  // namespace rayleaf
