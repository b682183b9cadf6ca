// How dense a medium is in a part of space: what is found at points there, and what that says of all of it.
#pragma once

#include "base/vector.h"

#include <span>

namespace rayleaf {

/// What is found at a point.
struct FoundDensity {
    Color extinction{0, 0, 0};  ///< per world unit
    float lookups = 0;          ///< per world unit, at least: 0 but where there is nothing but light
    bool scatters = false;
};

/// Per world unit. Not initialized: rays hold many.
struct DensityBounds {
    float majorant;  ///< extinction of the densest channel, hardly ever more
    float certain;   ///< of the thinnest, hardly ever less; 0 where it may not scatter
    float residual;  ///< how far the extinction of any channel is from `mean`, hardly ever more
    float limit;     ///< what is denser is rendered as dense as that
    Color mean;      ///< extinction

    static DensityBounds none() { return {0.0f, 0.0f, 0.0f, 0.0f, Color(0.0f)}; }
    DensityBounds& operator+=(const DensityBounds& other);
};

/// Of points that stand for a cell: `shown` for its mean, and `reserve` > 1 for what lies between all of them.
DensityBounds bounds_of(std::span<const FoundDensity> all, std::span<const FoundDensity> shown, float reserve);

}  // namespace rayleaf
