// Fills the irradiance cache before a frame, in passes over the picture: first every 16th pixel of every 16th row, then
// twice as dense, down to every pixel.
//
// A pass finds, in parallel, the diffuse points that its pixels see (directly, in mirrors, through glass) and that no
// record of the passes before may answer for; samples their hemispheres, in parallel; and stores them in the order of
// the pixels. So the cache does not depend on the number of threads, and the frame only reads it. Only the rendered
// part of the picture is looked at: a border has fewer records than the whole, and interpolates a little otherwise.
#pragma once

#include "base/cancel.h"
#include "integrators/distribution.h"

#include <memory>

namespace rayleaf {

/// Adds the rays it takes to `counts`. Throws Cancelled soon after `cancel` says so.
std::unique_ptr<IrradianceCache> fill_irradiance_cache(const Scene& scene, const Settings& settings,
                                                       const CancelToken& cancel, RayCounts& counts);

}  // namespace rayleaf
