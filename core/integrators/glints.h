// Lights seen in smooth reflections. Only chance finds them there: a window reflects a few percent of the light, so
// most paths go through it, and the lamp that it reflects comes as rare bright specks. Where a light is seen in a
// mirror direction, that is sampled more often than by its share, and weighs less.
#pragma once

#include "integrators/bounces.h"
#include "integrators/ray_counts.h"
#include "integrators/vertex.h"

namespace rayleaf {

/// Sets the glints of a vertex whose view is known, and the probabilities that depend on them. Of paths that have been
/// scattered by something rough, none is set: what they bring differs too much for a light to stand out.
void find_glints(const Scene& scene, const Bounces& bounces, Vertex& vertex, RayCounts& counts);

}  // namespace rayleaf
