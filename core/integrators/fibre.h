// Rays that go through hair: the lobes of a fibre tell what comes out of it, so what leaves it starts on its far side.
#pragma once

#include "scene/scene.h"

namespace rayleaf {

/// Moves the start of a ray that enters a round strand at `point` to where it leaves it, if `closures` are a fibre's.
void leave_fibre(const Scene& scene, const SurfacePoint& point, const Closures& closures, Ray& ray);

}  // namespace rayleaf
