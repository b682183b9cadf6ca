// The passes that show how the camera's rays were answered.
#pragma once

#include "film/pixel.h"
#include "integrators/volumes.h"
#include "trace/tracer.h"

namespace rayleaf {

/// Writes Rayleaf Mask, its colours, Rayleaf Error and Rayleaf Tree.
void write_answer(const Tracer& tracer, const ClosestHit& found, PixelSample& sample);
/// Writes Rayleaf Level.
void write_level(const Maybe<Hit>& hit, PixelSample& sample);
/// Writes Path Length, and in the others the values of volume objects where those say more.
void write_volumes(const VolumePassage& passage, PixelSample& sample);

}  // namespace rayleaf
