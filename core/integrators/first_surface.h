// The passes that describe the first surface a camera ray meets.
#pragma once

#include "film/pixel.h"
#include "integrators/vertex.h"
#include "scene/scene.h"

namespace rayleaf {

/// A surface at least this opaque is the one that Depth, Normal and the like describe (Blender's default threshold).
constexpr float kPassOpacity = 0.5f;
/// Depth where nothing is hit, as Blender's.
constexpr float kNoDepth = 1e10f;

inline bool is_opaque_enough(const Closures& closures) {
    return 1.0f - average(closures.unscattered()) >= kPassOpacity;
}

/// Whether the camera sees a hole there, whatever else the material has (as in Cycles).
inline bool is_held_out(const Closures& closures) {
    return closures.holdout >= 1.0f;
}

/// Writes Depth, Position, Normal, Vector, UV and the indices.
void write_surface(const Scene& scene, const Vertex& vertex, PixelSample& sample);

/// Adds the share of Mist that this surface blocks; `throughput` is the path's.
void write_mist(const Scene& scene, const PathSettings& settings, const Vertex& vertex, const Color& throughput,
                PixelSample& sample);
/// Records the surface's object, material and asset for Cryptomatte.
void write_matte(const Scene& scene, const Vertex& vertex, const Color& throughput, PixelSample& sample);

/// Colour of the lobes of each kind, as the camera sees them.
ByKind albedo_by_kind(const Vertex& vertex, const Color& throughput);

}  // namespace rayleaf
