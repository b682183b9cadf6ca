// The groups of which light shines on a point: each sun, the world, all lights that have a place. One is chosen first.
#pragma once

#include "base/float4.h"

#include <cmath>

namespace rayleaf {

struct LightGroups {
    /// By what one is chosen: the cosine at the point, and the irradiance there.
    struct Weight {
        double cosine = 0, irradiance = 0;
    };
    bool has_tree = false;  ///< lights that have a place shine on it
    Weight of_tree, total;
    Float4 first_of_tree{};  ///< weights of the tree's first branch (LightTree::first_weights)

    void add(const Weight& weight) {
        total.cosine += weight.cosine;
        total.irradiance += weight.irradiance;
    }
    /// Once all are added.
    void complete() {
        /// The share of the probability that goes by cosines alone: the tree's irradiance is a rough guess.
        constexpr double kEvenShare = 0.5;
        const bool is_known = total.irradiance > 0 && std::isfinite(total.irradiance);
        by_cosine_ = (is_known ? kEvenShare : 1.0) / total.cosine;
        by_irradiance_ = is_known ? (1.0 - kEvenShare) / total.irradiance : 0.0;
    }
    double probability(const Weight& weight) const {
        const double even = by_cosine_ * weight.cosine;
        return by_irradiance_ > 0.0 ? even + by_irradiance_ * weight.irradiance : even;
    }
    double tree_probability() const { return probability(of_tree); }

  private:
    double by_cosine_ = 0, by_irradiance_ = 0;
};

}  // namespace rayleaf
