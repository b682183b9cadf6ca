// What a ray cache can make of a material: whether rays that meet it go on as from a mirror or through clear glass.
#pragma once

#include "scene/description.h"

namespace rayleaf {

/// Clear glass as a body: a ray that enters is followed to where it leaves, by refraction wherever there is any, else
/// by total internal reflection. Partial reflections inside are left out; their light is taken to leave with the rest.
struct GlassBody {
    double ior = 1.45;         ///< index inside over that outside
    Color leaving{1, 1, 1};    ///< factor on light that leaves through the surface
    Color reflected{1, 1, 1};  ///< and on light that is totally reflected inside
};

enum class SurfaceOptics : uint8_t { Other, Mirror, Glass };

struct MaterialOptics {
    SurfaceOptics surface = SurfaceOptics::Other;
    GlassBody glass;  ///< of Glass
};

/// Mirror: all lobes are singular reflections, the same everywhere. Glass: singular lobes of one index, of which some
/// let light through, and no straight transparency.
MaterialOptics optics_of(const Program& surface);

}  // namespace rayleaf
