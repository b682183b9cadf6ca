// The noise texture (noise.h) as FBM scaled to 0..1, at several points at once, in the lanes of vectors: the same bits
// as one by one.
#pragma once

#include "shading/noise.h"
#include "shading/operands.h"

#include <array>
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

    /// Of `count` points; x, y, z and w, which are multiplied by a scale.
    void set_points(const std::array<NumberRow, 4>& coordinates, const NumberRow& scale);
    void set_parameters(const NumberRow& details, const NumberRow& roughnesses, const NumberRow& distortions,
                        const NumberRow& lacunarities);
};

/// Points at which signed_noise is asked for, as the octaves of one point are, and what it is there.
struct NoisePoints {
    static constexpr size_t kMost = 32;
    /// From so many points on, lanes take less time.
    static constexpr size_t kLeast = 3;

    alignas(64) float point[4][kMost];
    alignas(64) float noise[kMost] = {};
    size_t count = 0;

    template <size_t N>
    void add(const std::array<float, N>& p) {
        for (size_t axis = 0; axis < N; ++axis) point[axis][count] = p[axis];
        ++count;
    }
    /// Sets `noise` of all, which have so many dimensions.
    void compute(int dimensions);
};

/// Fills `channels`, or only the first of them.
void noise_texture(int dimensions, NoiseChannels channels, NoiseLanes& lanes);

}  // namespace rayleaf
