// The length of a ray inside a closed shape, by tracing.
#pragma once

#include "trace/shape_scene.h"

namespace rayleaf {

/// In units of t, within the ray's [t_min, t_max]. Bodies of one shape that overlap count once; a ray that starts
/// inside counts from there.
double traced_length(const ShapeScene& scene, const Vec3d& origin, const Vec3d& direction, double t_min, double t_max);

}  // namespace rayleaf
