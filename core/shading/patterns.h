// Regular textures: gradients, waves, bricks, Blender's Magic, and white noise.
#pragma once

#include "base/vector.h"
#include "shading/variants.h"

#include <cstdint>

namespace rayleaf {

/// 0..1.
float gradient_texture(GradientVariant variant, const Vec3f& p);

enum class WaveShape : uint8_t { Bands, Rings };
/// Along or around which axis; Diagonal: bands along (1, 1, 1), or rings that are spheres.
enum class WaveAxis : uint8_t { X, Y, Z, Diagonal };

struct WaveParameters {
    WaveShape shape = WaveShape::Bands;
    WaveAxis axis = WaveAxis::X;
    WaveProfile profile = WaveProfile::SIN;
    float distortion = 0, detail = 2, detail_scale = 1, detail_roughness = 0.5f;  ///< noise that shifts the phase
    float phase = 0;                                                              ///< radians
};
/// 0..1.
float wave_texture(const Vec3f& p, const WaveParameters& parameters);

struct BrickParameters {
    float mortar_size = 0.02f, mortar_smooth = 0.1f;
    float bias = 0;  ///< how much all bricks are of the second colour, -1..1
    float width = 0.5f, height = 0.25f;
    float offset = 0.5f, squash = 1;  ///< how far every so manieth row is moved, in bricks, and how wide its bricks are
    int offset_every = 2, squash_every = 2;  ///< rows; 0: none
};
struct BrickResult {
    float tint = 0;    ///< 0..1, of the brick: how much it is of the second colour
    float mortar = 0;  ///< 0..1
};
BrickResult brick_texture(const Vec3f& p, const BrickParameters& parameters);

/// Sines of sums of sines; `depth` 0..10.
Color magic_texture(const Vec3f& p, int depth, float distortion);

/// By chance, 0..1 in each channel, as different as can be at neighbouring places. Of `point` the first `dimensions`
/// (1..4) components count; 1: only w.
Color white_noise(int dimensions, const Vec4f& point);

}  // namespace rayleaf
