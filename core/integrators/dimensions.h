// Which random numbers an integrator uses for what: the one table of the sampler's dimensions.
//
//   0..2                  the camera: filter, lens, time (render/session.cpp)
//   3..6                  Light and Scatter of the first two vertices
//   16 + 16 * v + ...     all else at vertex v of the path, counted from the camera, transparent surfaces included
//
// The first seven are spread evenly together (base/random.h).
// The sampler gives two stratified numbers a dimension, and three by joining a second one.
#pragma once

#include "base/random.h"

#include <cstdint>

namespace rayleaf {

/// Of the camera.
enum CameraDimension : uint32_t { kFilterDimension = 0, kLensDimension = 1, kTimeDimension = 2 };

enum class PathDimension : uint32_t {
    Light = 0,         ///< which light, and where on it
    Scatter = 1,       ///< which lobe, and the direction; three numbers where they are needed
    Transparency = 2,  ///< straight on or scattered; of sharp lobes, which of them as well
    Roulette = 3,
    Occlusion = 4,     ///< the pass
    Hemisphere = 5,    ///< distribution ray tracing: rays from diffuse lobes
    Walk = 6,          ///< path tracing: the tag of a walk below the surface
    Child = 6,         ///< the same: the tag of mirrors and refractions, with their number
    Portal = 7,        ///< of what is not scattered, straight on or by a portal
    Medium = 8,        ///< the way through media to the vertex: how far, by which channel
    MediumLight = 9,   ///< and where on which light that arrives on that way
    MediumPlace = 10,  ///< and where it arrives
    MediumWalk = 11,   ///< seeds a sequence of numbers for media that vary
    ShadowWalk = 12,   ///< the same for the ray to the light
    Probe = 13,        ///< the tag of what the material asks about its surroundings
    Below = 14         ///< distribution ray tracing: how light enters a body, and the tag of its walks
};

constexpr uint32_t kFirstPathDimension = 16;
constexpr uint32_t kDimensionsPerVertex = 16;

constexpr uint32_t dimension(int vertex, PathDimension use) {
    constexpr uint32_t kFirst = kTimeDimension + 1, kUses = 2, kVertices = 2;
    static_assert(kFirst + kUses * kVertices == kSharing);
    const uint32_t sharing = kFirst + kUses * static_cast<uint32_t>(vertex) + static_cast<uint32_t>(use);
    if (use <= PathDimension::Scatter && static_cast<uint32_t>(vertex) < kVertices) return sharing;
    return kFirstPathDimension + kDimensionsPerVertex * static_cast<uint32_t>(vertex) + static_cast<uint32_t>(use);
}

}  // namespace rayleaf
