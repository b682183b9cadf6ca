// What an interpolated hit has no derivatives for, by differences: the same question asked one pixel step away.
#pragma once

#include "integrators/vertex.h"
#include "scene/scene.h"

#include <array>
#include <optional>

namespace rayleaf {

/// The neighbouring rays in x and y of a picture, and where the ray cache of the same object says that they hit.
struct NeighbourHits {
    std::array<Ray, 2> rays;
    std::array<std::optional<Hit>, 2> hits;  ///< empty: traced, missed, or of another way through glass
};

/// `differential` is that of `ray`, transferred to the hit.
NeighbourHits neighbour_hits(const Scene& scene, const Ray& ray, const Hit& hit, const RayDifferential& differential);

/// Gives an interpolated point derivatives: its parameters are the picture's x and y. Flat where there is no neighbour.
void set_derivatives(const Scene& scene, const NeighbourHits& neighbours, const RayDifferential& differential,
                     SurfacePoint& point);

}  // namespace rayleaf
