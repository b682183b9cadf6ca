// Light that a scattered ray meets of lights with blockers of their own. The nearest surface in the ray's way says
// nothing about it: each such light on the ray's line is asked for, and a shadow ray for what is in between, as Cycles
// does.
#pragma once

#include "integrators/shadow.h"

#include <functional>

namespace rayleaf {

struct BlockedLight {
    Color radiance{0, 0, 0};  ///< what of it arrives
    float density = 0;        ///< LightSet's
    int light_group = -1;
};

/// `way`: of the ray, as it was scattered at `from`; `shadow`: the kind and state of a shadow ray from there. Rays of
/// the kind of `way` must see the light.
void find_blocked_lights(const Scene& scene, const FreeWay& way, const FreeWay& shadow, const LitPoint& from,
                         const std::function<void(const BlockedLight&)>& add);

}  // namespace rayleaf
