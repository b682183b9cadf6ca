#include "textures/picture.h"

#include <algorithm>
#include <cmath>

namespace rayleaf {
namespace {

constexpr float kLargestHalf = 65504.0f;

/// Decoding of sRGB (IEC 61966-2-1).
float linear_from_srgb(float x) {
    if (x <= 0.04045f) return x / 12.92f;
    return std::pow((x + 0.055f) / 1.055f, 2.4f);
}

/// To linear light with associated alpha. Data images keep their channels as they are.
void linearize(Picture& picture, ColorSpace space) {
    if (space == ColorSpace::NonColor) return;
    const int alpha_channel = picture.alpha_channel();
    const int colors = alpha_channel >= 0 ? alpha_channel : picture.channels;
    const size_t channels = static_cast<size_t>(picture.channels);
    for (size_t i = 0; i < picture.pixels.size(); i += channels) {
        float* pixel = &picture.pixels[i];
        const float alpha = alpha_channel >= 0 ? pixel[alpha_channel] : 1.0f;
        for (int c = 0; c < colors; ++c) {
            float x = pixel[c];
            if (picture.alpha == Alpha::Associated && space == ColorSpace::Srgb && alpha > 0.0f)
                x = linear_from_srgb(x / alpha) * alpha;
            else if (space == ColorSpace::Srgb)
                x = linear_from_srgb(x);
            if (picture.alpha == Alpha::Straight) x *= alpha;
            pixel[c] = x;
        }
    }
}

/// Values a half float cannot hold ask for floats; infinities and NaN, which some panoramas contain, become numbers.
void make_finite(Picture& picture) {
    for (float& x : picture.pixels) {
        if (!std::isfinite(x)) x = x > 0.0f ? kLargestHalf : 0.0f;
        if (std::abs(x) > kLargestHalf) picture.precise = true;
    }
}

/// One to four channels: grey, grey and alpha become what lookups know: 1, 3 or 4.
void normalize_channels(Picture& picture) {
    const int from = picture.channels, to = from == 2 ? 4 : std::min(from, 4);
    if (from == to) return;
    const size_t count = static_cast<size_t>(picture.width) * static_cast<size_t>(picture.height);
    std::vector<float> pixels(count * static_cast<size_t>(to));
    for (size_t i = 0; i < count; ++i)
        for (int c = 0; c < to; ++c) {
            const int source = from == 2 ? (c == 3 ? 1 : 0) : c;
            pixels[i * static_cast<size_t>(to) + static_cast<size_t>(c)] =
                picture.pixels[i * static_cast<size_t>(from) + static_cast<size_t>(source)];
        }
    picture.pixels = std::move(pixels);
    picture.channels = to;
}

}  // namespace

void prepare(Picture& picture, ColorSpace space) {
    normalize_channels(picture);
    linearize(picture, space);
    make_finite(picture);
}

}  // namespace rayleaf
