// The length of a ray inside a closed shape, by tracing.
#pragma once

#include "trace/shape_scene.h"

namespace rayleaf {

/// How far beyond a crossing a line continues, local units: above the rounding of two facets that share an edge, below
/// any thickness that matters.
inline constexpr double kCrossingStep = 0x1p-20;

/// In units of t, within the ray's [t_min, t_max], at a time of the shutter. Bodies of one shape that overlap count
/// once; a ray that starts inside counts from there.
double traced_length(const ShapeScene& scene, const Vec3d& origin, const Vec3d& direction, float time, double t_min,
                     double t_max);

}  // namespace rayleaf
