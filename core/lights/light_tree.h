// Choice of one of many lights: a binary tree whose nodes know the power and the place of the lights below them.
//
// A reduced light tree (A. Conty Estevez, C. Kulla: Importance Sampling of Many Lights with Adaptive Tree Splitting,
// HPG 2018, section 4): a node is chosen in proportion to intensity over squared distance, times the cosines at the
// lights (their orientation cones) and at the point; one of the up to four that are two levels below the last, which
// are weighed together (lights/light_branch.h). Without the part of the paper that splits nodes. A single light may say
// that its light does not arrive. Cosines are bounds for a node's sphere; none counts as less than kLeastCosine
// (lights/cosines.h). One light costs O(log n), and the choice is a pure function of the point and the random number.
#pragma once

#include "base/cancel.h"
#include "base/vector.h"
#include "lights/light_branch.h"
#include "lights/light_groups.h"
#include "lights/light_linking.h"
#include "rays/ray.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
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
};

class LightTree {
  public:
    /// Throws Cancelled soon after `cancel` says so.
    explicit LightTree(const std::vector<LightTreeItem>& items, const CancelToken& cancel = kNeverCancelled);

    bool empty() const { return nodes_.empty(); }
    /// The tree's against suns and the world: the cosine at the point, at best, and a rough estimate of the irradiance
    /// of all lights there.
    LightGroups::Weight weight(const LitPoint& at) const;
    /// Whether the first `end` of a ray may cross the bounds of any light.
    bool is_crossed(const Ray& ray, double end) const { return !nodes_.empty() && may_cross(nodes_.front(), ray, end); }
    /// Whether any light shines on a point, by their links alone.
    bool shines_on(const LitPoint& at) const { return !nodes_.empty() && is_linked(0, at.lit_by); }

    struct Choice {
        uint32_t item = 0;
        double probability = 0;
        double left_over = 0;  ///< of the random number: again in [0,1)
    };
    /// `random` in [0,1). Empty where no light arrives. `reaches(item)` is asked of single lights only.
    template <typename Reaches>
    std::optional<Choice> choose(const LitPoint& at, double random, const Reaches& reaches) const;
    /// The probability with which `choose` returns `item`, which shines on the point.
    template <typename Reaches>
    double probability(const LitPoint& at, uint32_t item, const Reaches& reaches) const;

    struct Light {
        Vec3d center;
        double radius = 0;     ///< of the sphere about its box
        double intensity = 0;  ///< as it was given
        LightSets set = kLightsOfAll;
    };
    Light light(uint32_t item) const;
    size_t count() const { return place_of_item_.size(); }

    /// Calls `visit(item)` for every light whose bounds the first `end` of a ray may cross.
    template <typename Visit>
    void visit_crossed(const Ray& ray, double end, const Visit& visit) const {
        if (!nodes_.empty()) visit_crossed(nodes_.front(), ray, end, visit);
    }

    size_t bytes() const;

  private:
    struct Node {
        Vec3d center;
        double radius_squared = 0;  ///< of the sphere about the box
        double intensity = 0;
        uint32_t left = 0;  ///< the right child follows its left sibling; 0: a leaf
        uint32_t item = 0;  ///< of a leaf

        bool is_around(const Vec3d& position) const { return !((center - position).length2() > radius_squared); }
    };
    struct Place {
        uint32_t branch = 0, lane = 0;
    };
    std::vector<Node> nodes_;
    std::vector<LightBranch> branches_;  ///< the first holds the root alone
    std::vector<Place> place_of_item_;
    std::vector<Box3d> bodies_;
    std::vector<LightSets> sets_;  ///< per node, of all its lights; empty where all shine on all

    bool is_linked(size_t node, LightSets lit_by) const { return sets_.empty() || (sets_[node] & lit_by) != 0; }
    double irradiance(const LightBranch& branch, const LitPoint& at, int depth) const;
    void add_branch(std::span<const uint32_t> nodes, const Place& parent, std::span<const LightCone> cones);
    void gather_sets(const std::vector<LightTreeItem>& items);
    void build(const std::vector<LightTreeItem>& items, std::vector<uint32_t>& order, size_t begin, size_t end,
               uint32_t node, std::vector<LightCone>& cones, const CancelToken& cancel);

    template <typename Reaches>
    LightBranch::Lanes weights(const LightBranch& branch, const LitPoint& at, const Reaches& reaches) const {
        LightBranch::Lanes shining = branch.intensity;
        for (size_t i = 0; i < branch.count; ++i)
            if (!is_linked(branch.node[i], at.lit_by) || (branch.is_leaf(i) && !reaches(branch.below[i])))
                shining[i] = 0.0f;
        return branch.weights(at, shining, branch.has_bodies ? sides(branch, at) : branch.side);
    }
    /// Those that are seen from the point.
    LightBranch::Lanes sides(const LightBranch& branch, const LitPoint& at) const;
    static double sum(const LightBranch::Lanes& weights) {
        return (double{weights[0]} + double{weights[1]}) + (double{weights[2]} + double{weights[3]});
    }

    static bool may_cross(const Node& node, const Ray& ray, double end) {
        const Vec3d offset = node.center - ray.origin;
        const double nearest = std::max(0.0, std::min(offset.dot(ray.direction), end));
        // Rounding of the offset counts where lights are far smaller than their distance.
        const double slack = node.radius_squared * kRoundingShare + offset.length2() * kRounding;
        return !((offset - ray.direction * nearest).length2() > node.radius_squared + slack);
    }
    template <typename Visit>
    void visit_crossed(const Node& node, const Ray& ray, double end, const Visit& visit) const {
        if (!may_cross(node, ray, end)) return;
        if (node.left == 0) return visit(node.item);
        visit_crossed(nodes_[node.left], ray, end, visit);
        visit_crossed(nodes_[node.left + 1], ray, end, visit);
    }

    static constexpr double kRoundingShare = 1e-6;  ///< of a squared radius
    static constexpr double kRounding = 1e-24;  ///< of a squared distance: some thousand times its rounding, squared
};

template <typename Reaches>
std::optional<LightTree::Choice> LightTree::choose(const LitPoint& at, double random, const Reaches& reaches) const {
    if (!shines_on(at)) return std::nullopt;
    const LightBranch* branch = branches_.data();
    Choice choice{branch->below[0], 1.0, random};
    for (bool is_leaf = branch->is_leaf(0); !is_leaf;) {
        branch = &branches_[choice.item];
        const LightBranch::Lanes weights = this->weights(*branch, at, reaches);
        const double total = sum(weights);
        if (!(total > 0)) return std::nullopt;
        double rest = choice.left_over * total;
        size_t lane = 0;
        for (size_t i = 0; i < branch->count; ++i) {
            if (!(weights[i] > 0.0f)) continue;
            lane = i;
            if (rest < double{weights[i]}) break;
            rest -= double{weights[i]};  // of the last as well, where rounding led past it
        }
        const double weight = weights[lane];
        choice.left_over = std::min(rest / weight, 1.0 - 0x1p-53);
        choice.probability *= weight / total;
        choice.item = branch->below[lane];
        is_leaf = branch->is_leaf(lane);
    }
    return choice;
}

template <typename Reaches>
double LightTree::probability(const LitPoint& at, uint32_t item, const Reaches& reaches) const {
    double probability = 1.0;
    for (Place place = place_of_item_[item]; place.branch != 0;) {
        const LightBranch& branch = branches_[place.branch];
        const LightBranch::Lanes weights = this->weights(branch, at, reaches);
        const double total = sum(weights);
        probability *= total > 0 ? double{weights[place.lane]} / total : 0.0;
        place = {branch.parent, branch.lane_of_parent};
    }
    return probability;
}

}  // namespace rayleaf
