// Choice of one of many lights: a binary tree whose nodes know the power and the place of the lights below them.
//
// A reduced light tree (A. Conty Estevez, C. Kulla: Importance Sampling of Many Lights with Adaptive Tree Splitting,
// HPG 2018, section 4): at each node the side is chosen in proportion to intensity over squared distance, times the
// cosines at the lights (their orientation cones) and at the point. Without the part of the paper that splits nodes. A
// single light may say that its light does not arrive. Cosines are bounds for a node's sphere; none counts as less than
// kLeastCosine (lights/cosines.h). One light costs O(log n), and the choice is a pure function of the point and the
// random number.
#pragma once

#include "base/cancel.h"
#include "base/vector.h"
#include "lights/cosines.h"
#include "lights/light_groups.h"
#include "lights/light_linking.h"
#include "rays/ray.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace rayleaf {

/// Where a light shines, by the cosine to its normals, which lie in a cone.
struct LightCone {
    Vec3f axis{0, 0, 0};  ///< unit; zero: it shines alike in all directions
    float cosine = 1;     ///< of the angle between the axis and a normal, at most
    /// Whether it shines to the side of the normals, and to the other, outside `body`.
    bool ahead = true, back = true;
    Box3d body = {};  ///< around an object from within which both sides may be seen; world; empty: there is none
};

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
    size_t count() const { return leaf_of_item_.size(); }

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
        float radius = 0;     ///< of the sphere
        Vec3f axis{0, 0, 0};  ///< LightCone's
        HalfAngle spread;     ///< between the axis and a normal, at most
        int32_t body = -1;    ///< in `bodies_`, where one side alone is seen from outside; -1: both are
        bool ahead = true;    ///< the side that is seen
        uint32_t parent = 0;
        uint32_t left = 0;  ///< the right child follows its left sibling; 0: a leaf
        uint32_t item = 0;  ///< of a leaf
    };
    std::vector<Node> nodes_;
    std::vector<uint32_t> leaf_of_item_;
    std::vector<Box3d> bodies_;
    std::vector<LightSets> sets_;  ///< per node, of all its lights; empty where all shine on all

    bool is_linked(size_t node, LightSets lit_by) const { return sets_.empty() || (sets_[node] & lit_by) != 0; }
    double irradiance(size_t index, const LitPoint& at, int depth) const;
    void set_cone(Node& node, const LightCone& cone);
    void gather_sets(const std::vector<LightTreeItem>& items);
    void build(const std::vector<LightTreeItem>& items, std::vector<uint32_t>& order, size_t begin, size_t end,
               uint32_t node, const CancelToken& cancel);

    /// A node's sphere as it is seen from a point.
    struct View {
        bool is_inside;
        double falloff;  ///< with the distance
        // From outside:
        Vec3f direction;
        HalfAngle cone;

        View(const Node& node, const Vec3d& position) {
            const Vec3d offset = node.center - position;
            const double distance_squared = offset.length2();
            is_inside = !(distance_squared > node.radius_squared);
            if (is_inside) {  // the distance says nothing; half the radius is as good a guess as any
                falloff = 1.0 / std::max({distance_squared, 0.25 * node.radius_squared, kNearest});
                return;
            }
            const double inverse = 1.0 / std::sqrt(distance_squared);
            falloff = std::min(inverse * inverse, 1.0 / kNearest);
            direction = Vec3f(offset * inverse);
            cone = HalfAngle::of_sine(node.radius * static_cast<float>(inverse));
        }
    };
    template <typename Reaches>
    double importance(size_t index, const LitPoint& at, const Reaches& reaches) const {
        const Node& node = nodes_[index];
        if (!is_linked(index, at.lit_by) || (node.left == 0 && !reaches(node.item))) return 0.0;
        const View view(node, at.position);
        if (view.is_inside) return node.intensity * view.falloff;
        const float at_point = cosine_at_surface(at.normal, view.direction, view.cone);
        return node.intensity * (at_point * at_light(node, at, view)) * view.falloff;
    }
    /// The cosine at a node's lights, at best, from outside its sphere.
    float at_light(const Node& node, const LitPoint& at, const View& view) const {
        if (node.axis == Vec3f(0.0f)) return 1.0f;
        const float along = -view.direction.dot(node.axis);
        const bool both = node.body < 0 || bodies_[static_cast<size_t>(node.body)].intersects(at.position);
        const float cosine = both ? std::abs(along) : node.ahead ? along : -along;
        return std::max(kLeastCosine, narrowed(cosine, view.cone + node.spread));
    }
    /// Probability of the left child.
    template <typename Reaches>
    double left_share(const Node& node, const LitPoint& at, const Reaches& reaches) const {
        const double left = importance(node.left, at, reaches);
        const double right = importance(size_t{node.left} + 1, at, reaches);
        if (left == 0 && right == 0) return 0.5;
        return left / (left + right);
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
    static constexpr double kNearest = 1e-30;   ///< squared distance, world units²; keeps importances finite
};

template <typename Reaches>
std::optional<LightTree::Choice> LightTree::choose(const LitPoint& at, double random, const Reaches& reaches) const {
    if (!shines_on(at)) return std::nullopt;
    const Node* node = nodes_.data();
    Choice choice{0, 1.0};
    while (node->left != 0) {
        const double left = left_share(*node, at, reaches);
        const bool goes_left = random < left;
        random = goes_left ? random / left : (random - left) / (1.0 - left);
        random = std::min(random, 1.0 - 0x1p-53);
        choice.probability *= goes_left ? left : 1.0 - left;
        node = &nodes_[node->left + (goes_left ? 0 : 1)];
    }
    // Among lights that do not arrive it ends anywhere.
    if (!(choice.probability > 0) || !is_linked(static_cast<size_t>(node - nodes_.data()), at.lit_by))
        return std::nullopt;
    choice.item = node->item;
    choice.left_over = random;
    return choice;
}

template <typename Reaches>
double LightTree::probability(const LitPoint& at, uint32_t item, const Reaches& reaches) const {
    double probability = 1.0;
    uint32_t index = leaf_of_item_[item];
    while (index != 0) {
        const Node& parent = nodes_[nodes_[index].parent];
        const double left = left_share(parent, at, reaches);
        probability *= index == parent.left ? left : 1.0 - left;
        index = nodes_[index].parent;
    }
    return probability;
}

}  // namespace rayleaf
