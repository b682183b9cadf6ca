// How much light of a sampled light arrives: nothing behind opaque surfaces, a product behind transparent ones.
#pragma once

#include "base/random_stream.h"
#include "integrators/bounces.h"
#include "integrators/medium_stack.h"
#include "rays/packet.h"
#include "scene/scene.h"

#include <span>

namespace rayleaf {

/// Makes `ray`, a new one, that from a point to a light. False where nothing can be in the way.
bool set_shadow_ray(const Scene& scene, const SurfacePoint& point, const LightSample& light, Ray& ray);

/// A way along which it is asked how much light gets through.
struct FreeWay {
    Ray ray;
    RayDifferential differential;  ///< where it leaves its origin
    Visibility kind = kVisibleShadow;
    PathState state;
    int transparent_left = 0;  ///< more transparent surfaces let nothing through
    RayWidening widening;
    MediumStack media;      ///< in which it starts
    RandomStream random{};  ///< for media that vary
};

/// Share of light that surfaces let straight through along the way, and media.
Color free_share(const Scene& scene, FreeWay way);
/// The same for several ways, the rays of which are traced in packets; the ways are used up.
void free_shares(const Scene& scene, std::span<FreeWay> ways, Coherence coherence, Color* shares);
/// The same for ways that lie apart: at most a packet.
void free_shares_of_packet(const Scene& scene, std::span<FreeWay* const> ways, Coherence coherence, Color* shares);

}  // namespace rayleaf
