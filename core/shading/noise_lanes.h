// The noise texture (noise.h) as FBM brought to 0..1, at several points at once, in the lanes of vectors: the same bits
// as one by one.
#pragma once

#include "shading/noise.h"

#include <cstddef>
#include <cstdint>

namespace rayleaf {

/// From so many points on, lanes take less time.
inline constexpr uint32_t kLeastNoiseLanes = 3;

/// Points and what is asked of the texture there; then its channels. Rows are as long as the widest vectors need.
struct NoiseLanes {
    static constexpr size_t kMost = 32;

    alignas(64) float point[4][kMost];  ///< x, y, z, w
    alignas(64) float detail[kMost], roughness[kMost], distortion[kMost], lacunarity[kMost];
    alignas(64) float channels[3][kMost];
    size_t count = 0;

    /// From registers: `vector` has x, y and z of `points` points after one another; null numbers are the operation's
    /// defaults.
    void set_points(const float* vector, const float* w, const float* scale, size_t points);
    /// Of those points.
    void set_parameters(const float* details, const float* roughnesses, const float* distortions,
                        const float* lacunarities);
};

/// Fills `channels`, or only the first of them.
void noise_texture(int dimensions, NoiseChannels channels, NoiseLanes& lanes);

}  // namespace rayleaf
