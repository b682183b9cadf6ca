// Colour nodes: blending, colour models, grading, ramps. Channels are linear unless a model says otherwise; hues run
// 0..1 from red through green.
#pragma once

#include "base/vector.h"
#include "shading/variants.h"

#include <span>

namespace rayleaf {

/// Blends `b` over `a` (linear interpolation for MIX); `factor` per channel (Blender's plain factor repeats one). The
/// models of hue, saturation, colour and value use its first channel.
Vec3f blend(BlendVariant variant, const Vec3f& factor, const Vec3f& a, const Vec3f& b);
/// One channel of many colours; false: the type is one of those models.
bool blend_rows(BlendVariant variant, size_t count, const float* factor, const float* a, const float* b, float* result);

Vec3f rgb_to_hsv(const Vec3f& rgb);
Vec3f hsv_to_rgb(const Vec3f& hsv);
Vec3f rgb_to_hsl(const Vec3f& rgb);
Vec3f hsl_to_rgb(const Vec3f& hsl);

/// Positive channels to the power `gamma`; a gamma of 0 gives white.
Vec3f gamma_correct(const Vec3f& color, float gamma);
Vec3f bright_contrast(const Vec3f& color, float bright, float contrast);
/// Blender's Hue Saturation Value node: hue 0.5 is neutral.
Vec3f hue_saturation(const Vec3f& color, float hue, float saturation, float value, float factor);
/// Row-major rgba entries at equal steps over [0, 1]; x outside takes the end.
Vec4f table_value(std::span<const float> entries, float x, bool linear);

}  // namespace rayleaf
