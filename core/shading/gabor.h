// Gabor noise: waves that begin and end around points by chance (Lagae, Lefebvre, Drettakis, Dutré: "Procedural Noise
// using Sparse Gabor Convolution", SIGGRAPH 2009). The waves are complex, so that the noise has a phase and an
// intensity as well (Tricard et al.: "Procedural Phasor Noise", SIGGRAPH 2019), and it is scaled by its deviation
// (Tavernier et al.: "Making Gabor Noise Fast and Normalized", Eurographics 2019).
//
// Departures, which are Blender's: waves end at distance 1 by a Hann window, each cell of a unit grid holds eight, and
// their points and weights are those of Blender's hashes. Six deviations are the range 0..1.
#pragma once

#include "base/vector.h"

namespace rayleaf {

struct GaborParameters {
    float frequency = 2;          ///< waves per unit
    float anisotropy = 1;         ///< 1: all waves run one way, 0: any way
    float orientation = kPi / 4;  ///< of the way, in two dimensions: radians from x to y
    Vec3f direction{1, 1, 0};     ///< the way in three dimensions, of any length
};

struct GaborResult {
    float value = 0.5f;   ///< 0..1 but for rare values
    float phase = 0;      ///< 0..1 along a wave
    float intensity = 0;  ///< how strong waves are there, on the scale of `value`
};

/// Of `point` the first `dimensions` (2, 3) components count.
GaborResult gabor_texture(int dimensions, const Vec3f& point, const GaborParameters& parameters);

}  // namespace rayleaf
