// A ray's width from its differential: how finely what it meets must be diced.
#pragma once

#include "rays/ray.h"
#include "rays/ray_differential.h"

namespace rayleaf {

inline Ray with_footprint(Ray ray, const RayDifferential& differential) {
    ray.width = differential.width();
    ray.spread = differential.angle();
    return ray;
}

}  // namespace rayleaf
