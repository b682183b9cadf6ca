// The groups of which light shines on a point: each sun, the world, all lights that have a place. One is chosen first.
#pragma once

#include "base/float4.h"
#include "lights/whole_parts.h"

#include <cmath>

namespace rayleaf {

class LightGroups {
  public:
    /// By what one is chosen: the cosine at the point, and the irradiance there.
    struct Weight {
        double cosine = 0, irradiance = 0;

        Weight operator+(const Weight& other) const { return {cosine + other.cosine, irradiance + other.irradiance}; }
    };

    LightGroups() = default;
    /// `total`: of all.
    explicit LightGroups(const Weight& total) {
        /// The share of the probability that goes by cosines alone: the tree's irradiance is a rough guess.
        constexpr double kEvenShare = 0.5;
        const bool is_known = total.irradiance > 0 && std::isfinite(total.irradiance);
        by_cosine_ = total.cosine > 0 ? (is_known ? kEvenShare : 1.0) / total.cosine : 0.0;
        by_irradiance_ = is_known ? (1.0 - kEvenShare) / total.irradiance : 0.0;
    }
    /// Of a sun, once all is divided.
    double probability(const Weight& weight) const {
        const double exact = exact_probability(weight);
        return is_rounded_ ? whole_parts(exact * kPartsOfChoice) / kPartsOfChoice : exact;
    }
    /// Finds the probabilities of the world and the tree, of which one takes what remains; a weight of zero where one
    /// does not shine. `of_suns()`: the sum of theirs, as they are now.
    template <typename OfSuns>
    void divide(const Weight& world, const Weight& tree, const OfSuns& of_suns) {
        const bool has_tree = tree.cosine > 0.0;
        const double exact = exact_probability(has_tree ? tree : world);
        is_rounded_ = exact > 0.0;
        of_world_ = has_tree ? probability(world) : 0.0;
        const double rest = is_rounded_ ? 1.0 - of_suns() - of_world_ : 0.0;
        if (!(rest > 0.5 * exact)) {  // too little would be left
            is_rounded_ = false;
            of_world_ = exact_probability(world);
            of_tree_ = exact_probability(tree);
        } else {
            (has_tree ? of_tree_ : of_world_) = rest;
        }
    }
    double of_world() const { return of_world_; }
    double of_tree() const { return of_tree_; }

    Float4 first_of_tree{};  ///< weights of the tree's first branch (LightTree::first_weights), in whole parts

  private:
    double by_cosine_ = 0, by_irradiance_ = 0;
    double of_world_ = 0, of_tree_ = 0;
    bool is_rounded_ = false;  ///< probabilities are in whole parts (lights/whole_parts.h)

    double exact_probability(const Weight& weight) const {
        const double even = by_cosine_ * weight.cosine;
        return by_irradiance_ > 0.0 ? even + by_irradiance_ * weight.irradiance : even;
    }
};

}  // namespace rayleaf
