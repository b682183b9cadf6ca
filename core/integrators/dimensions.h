// Which random numbers an integrator uses for what: the one table of the sampler's dimensions.
//
//   0..15                 the camera: filter, lens (render/session.cpp)
//   16 + 16 * v + ...     vertex v of the path, counted from the camera, transparent surfaces included
//
// The sampler gives two stratified numbers a dimension, and three by joining a second one.
#pragma once

#include <cstdint>

namespace rayleaf {

/// Of the camera.
enum CameraDimension : uint32_t { kFilterDimension = 0, kLensDimension = 1 };

enum class PathDimension : uint32_t {
    Light = 0,         ///< which light, and where on it: three numbers
    Scatter = 1,       ///< which lobe, and the direction: three numbers
    Transparency = 2,  ///< straight on or scattered
    Roulette = 3,
    Occlusion = 4,   ///< the pass
    Hemisphere = 5,  ///< distribution ray tracing: rays from diffuse lobes
    Walk = 6,        ///< path tracing: the tag of a walk below the surface
    Child = 6        ///< the same: the first of the tags of mirrors and refractions; 6 to 15
};

constexpr uint32_t kFirstPathDimension = 16;
constexpr uint32_t kDimensionsPerVertex = 16;

constexpr uint32_t dimension(int vertex, PathDimension use) {
    return kFirstPathDimension + kDimensionsPerVertex * static_cast<uint32_t>(vertex) + static_cast<uint32_t>(use);
}

}  // namespace rayleaf
