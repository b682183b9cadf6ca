// The groups of which light shines on a point: each sun, the world, all lights that have a place. One is chosen first.
#pragma once

#include <cmath>

namespace rayleaf {

struct LightGroups {
    /// By what one is chosen: the cosine at the point, and the irradiance there.
    struct Weight {
        double cosine = 0, irradiance = 0;
    };
    bool has_tree = false;  ///< lights that have a place shine on it
    Weight of_tree, total;

    void add(const Weight& weight) {
        total.cosine += weight.cosine;
        total.irradiance += weight.irradiance;
    }
    double probability(const Weight& weight) const {
        /// The share of the probability that goes by cosines alone: the tree's irradiance is a rough guess.
        constexpr double kEvenShare = 0.5;
        const double even = weight.cosine / total.cosine;
        if (!(total.irradiance > 0) || !std::isfinite(total.irradiance)) return even;
        return kEvenShare * even + (1.0 - kEvenShare) * weight.irradiance / total.irradiance;
    }
    double tree_probability() const { return probability(of_tree); }
};

}  // namespace rayleaf
