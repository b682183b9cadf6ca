// Path tracing: light and scattering sampled together by the power heuristic (Veach 1997).
#pragma once

#include "base/random.h"
#include "film/pixel.h"
#include "scene/scene.h"
#include "scene/settings.h"

namespace rayleaf {

/// Traces one path from the camera ray and returns what it contributes to each pass. Pure: equal arguments, equal bits.
/// Dimensions of `sampler` from 16 on are free for the path; the lower ones belong to the camera.
PixelSample trace_path(const Scene& scene, const Settings& settings, const CameraRay& camera_ray,
                       const Sampler& sampler);

}  // namespace rayleaf
