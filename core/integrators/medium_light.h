// Light that media scatter straight from lamps, emitting surfaces and the world into a ray.
#pragma once

#include "base/maybe.h"
#include "base/random.h"
#include "integrators/medium_tracking.h"
#include "integrators/shadow.h"

namespace rayleaf {

/// Width to which what media scatter opens, radians: as of a diffuse surface.
inline constexpr float kScatteredWidth = 0.5f;

struct ScatteredLight {
    Color value{0, 0, 0};       ///< what arrives at the begin of the segment if nothing hides the light
    int light_group = -1;       ///< its slot; -1: none
    bool casts_shadow = false;  ///< something may hide it, along `ray`
    Ray ray;                    ///< from the place to the light
    Visibility kind = kVisibleShadow;
};

/// One light from one place on the segment, by the random numbers of vertex `vertex` of a path. `kind` and `shadow` are
/// those of its shadow rays.
Maybe<ScatteredLight> scattered_light(const MediumSegment& segment, const SegmentBounds& bounds,
                                      const Color& throughput, const Sampler& sampler, int vertex, Visibility kind,
                                      const PathState& shadow);

/// Where a medium scatters a path at a point on `segment`; `goes_on`: light may be scattered once more after that.
std::optional<PhaseSample> scattered_direction(const MediumSegment& segment, const MediumPassage& passage, bool goes_on,
                                               const Vec3f& random);

}  // namespace rayleaf
