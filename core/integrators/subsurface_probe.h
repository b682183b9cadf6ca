// Where light that enters a body leaves it by a profile of the distance alone (P. Christensen, B. Burley, *Approximate
// Reflectance Profiles for Efficient Subsurface Scattering*, Pixar Technical Memo 15-04, 2015). As in Cycles the width
// is the mean free path, without the paper's fit to the albedo. The place is found by probes through the body (A. King,
// C. Kulla, A. Conty, M. Fajardo, *BSSRDF Importance Sampling*, SIGGRAPH Talks 2013).
#pragma once

#include "integrators/subsurface_walk.h"

namespace rayleaf {

/// `ray` brings the width and the time of the one that enters. Empty where the probe misses the body. `dimension` is as
/// of `walk_below`.
std::optional<SubsurfaceExit> probe_beside(const Scene& scene, const SubsurfaceStart& start, const Ray& ray);

}  // namespace rayleaf
