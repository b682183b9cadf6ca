// Perlin's gradient noise and its fractal sums, as Blender's Noise Texture has them: gradients chosen by Bob Jenkins'
// lookup3 hash of the lattice point, quintic blending (Perlin, "Improving Noise", 2002), in one to four dimensions.
#pragma once

#include "base/vector.h"
#include "shading/fractals.h"

#include <cstdint>

namespace rayleaf {

/// Noise in [-1, 1], of one to four dimensions. A coordinate beyond 32-bit lattice indices, or not finite, counts as 0.
template <int N>
float signed_noise(const LatticePoint<N>& p);

struct NoiseParameters {
    float detail = 0;       ///< octaves beyond the first, 0..15; a fraction blends in the next one
    float roughness = 0.5;  ///< amplitude of an octave over that of the one before; normalized noise: 0..1
    float distortion = 0;   ///< how far noise displaces the coordinate before the sum
    FractalType type = FractalType::FBM;
    bool normalize = true;         ///< of FBM: the sum is scaled to 0..1
    float lacunarity = 2;          ///< frequency of an octave over that of the one before
    float offset = 0, gain = 1.0;  ///< of the types that have them (shading/fractals.h)
};

/// What is asked of a texture: one number, or three at thrice the cost.
enum class NoiseChannels : uint8_t { Factor, All };

/// The texture at `point`, of which the first `dimensions` (1..4) components count; 1: only w. The three channels are
/// independent, the first is Blender's factor; if only that is wanted, it stands in all three.
Vec3f noise_texture(int dimensions, const Vec4f& point, const NoiseParameters& parameters, NoiseChannels channels);

// Of the texture, for those who compute it in other ways (noise_lanes.cpp):
inline constexpr float kNoiseLatticeLimit = 2147483000.0f;                     ///< below 2^31
inline constexpr float kNoiseScale[4] = {0.2500f, 0.6616f, 0.9820f, 0.8344f};  ///< Blender's, make each dimension
                                                                               ///< fill [-1, 1]
/// Shifts that make one noise serve as several: 100..200 in each coordinate, from a hash of the seed.
float noise_seed_offset(int dimensions, int seed, int axis);

}  // namespace rayleaf
