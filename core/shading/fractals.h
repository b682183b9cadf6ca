// Fractal sums and products of gradient noise: Musgrave's five ways (Ebert et al., "Texturing and Modeling", chapter
// 16), which are Blender's Musgrave Texture up to 4.0 and the types of its Noise Texture since.
#pragma once

#include "base/vector.h"
#include "shading/lattice_hash.h"
#include "shading/variants.h"

namespace rayleaf {

/// Blender's limit of octaves beyond the first.
constexpr float kMostOctaves = 15.0f;

struct FractalParameters {
    float octaves = 1;     ///< how many; a fraction takes the last in part
    float amplitude = 1;   ///< of an octave over that of the one before
    float lacunarity = 2;  ///< frequency of an octave over that of the one before
    float offset = 0;      ///< added to each octave: HYBRID_MULTIFRACTAL, RIDGED_MULTIFRACTAL, HETERO_TERRAIN
    float gain = 1;        ///< how an octave weighs the next: HYBRID_MULTIFRACTAL, RIDGED_MULTIFRACTAL
};

/// The sum, or product, of octaves at `p`.
template <int N>
float fractal(FractalType type, const LatticePoint<N>& p, const FractalParameters& parameters);

/// Musgrave Texture at `point`, of which the first `dimensions` (1..4) components count; 1: only w. `detail` is the
/// number of octaves, `dimension` the exponent by which their amplitude falls with frequency.
float musgrave_texture(int dimensions, FractalType type, const Vec4f& point, float detail, float dimension,
                       FractalParameters parameters);

}  // namespace rayleaf
