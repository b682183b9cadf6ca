// Volume objects along a ray: x-rays of nonintersecting objects.
#pragma once

#include "scene/scene.h"

namespace rayleaf {

/// What the volume objects along a stretch of a ray add, and what they take from all that lies behind them.
struct VolumePassage {
    Color emission{0, 0, 0};
    Color transmittance{1, 1, 1};
    double length = 0;  ///< inside all of them, world units
    RayAnswer answer = RayAnswer::NotAsked;
    float error = 0;    ///< the largest that a ray cache reports
    uint32_t tree = 0;  ///< number of the first one's ray cache that has one; 0: none
};

/// Over [t_min, t_max] of the ray, for objects that rays of this kind see. Ordered by where the ray enters their boxes.
VolumePassage through_volumes(const Scene& scene, const Ray& ray, Visibility kind);

/// What gets through them.
inline Color free_of_volumes(const Scene& scene, const Ray& ray, Visibility kind) {
    return scene.volumes().empty() ? Color(1.0f) : through_volumes(scene, ray, kind).transmittance;
}

/// Which of two answers of objects along a ray its pixel shows: tracing above all, a miss last.
RayAnswer more_telling(RayAnswer a, RayAnswer b);

}  // namespace rayleaf
