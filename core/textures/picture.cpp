#include "textures/picture.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {

float decoded_srgb(float x) {
    if (x <= 0.04045f) return x / 12.92f;
    return std::pow((x + 0.055f) / 1.055f, 2.4f);
}

float encoded_srgb(float x) {
    if (x <= 0.0031308f) return x * 12.92f;
    return 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f;
}

namespace {

constexpr float kLargestHalf = 65504.0f;

/// The same, faster where a picture had eight bits: those values are looked up.
class SrgbDecoder {
  public:
    SrgbDecoder() {
        for (int i = 0; i <= kLargest; ++i) {
            encoded_[i] = from_byte(static_cast<uint8_t>(i));
            decoded_[i] = decoded_srgb(encoded_[i]);
        }
    }
    float of_byte(uint8_t byte) const { return decoded_[byte]; }
    float operator()(float x) const {
        const float nearest = x * kLargest + 0.5f;
        if (!(nearest >= 0.0f && nearest < kLargest + 1)) return decoded_srgb(x);
        const auto i = static_cast<size_t>(static_cast<int>(nearest));
        return encoded_[i] == x ? decoded_[i] : decoded_srgb(x);
    }

  private:
    static constexpr int kLargest = 255;
    float encoded_[kLargest + 1], decoded_[kLargest + 1];
};

/// How the values of a pixel become linear light with associated alpha.
struct Linearizing {
    const SrgbDecoder& decode;
    ColorSpace space;
    Alpha alpha;
    int channels, alpha_channel;  ///< alpha_channel: -1 without one

    void operator()(float* pixel) const {
        const int colors = alpha_channel >= 0 ? alpha_channel : channels;
        const float a = alpha_channel >= 0 ? pixel[alpha_channel] : 1.0f;
        for (int c = 0; c < colors; ++c) {
            float x = pixel[c];
            if (alpha == Alpha::Associated && space == ColorSpace::Srgb && a > 0.0f)
                x = decode(x / a) * a;
            else if (space == ColorSpace::Srgb)
                x = decode(x);
            if (alpha == Alpha::Straight) x *= a;
            pixel[c] = x;
        }
    }
};

/// By a configuration, whose curves are for colours that are not multiplied by alpha. Grey becomes the mean of what it
/// is as a colour, as in Cycles.
void transform_row(const ColorTransform& transform, std::span<float> row, const Picture& picture) {
    const auto channels = static_cast<size_t>(picture.channels);
    const size_t count = row.size() / channels;
    const auto alpha_of = [&](size_t i) {
        const bool divides = picture.alpha == Alpha::Associated && picture.alpha_channel() >= 0;
        const float alpha = divides ? row[i * channels + 3] : 1.0f;
        return alpha > 0.0f ? alpha : 1.0f;
    };
    std::vector<float> colors(3 * count);
    for (size_t i = 0; i < count; ++i)
        for (size_t c = 0; c < 3; ++c) colors[3 * i + c] = row[i * channels + (channels >= 3 ? c : 0)] / alpha_of(i);
    transform.apply(colors.data(), count);
    for (size_t i = 0; i < count; ++i) {
        const float* color = &colors[3 * i];
        if (channels < 3)
            row[i] = (color[0] + color[1] + color[2]) / 3.0f;
        else
            for (size_t c = 0; c < 3; ++c) row[i * channels + c] = color[c] * alpha_of(i);
    }
}

/// Infinities and NaN, which some panoramas contain, become numbers. Whether a half float can hold them all.
bool make_finite(std::span<float> row) {
    bool fits = true;
    for (float& x : row) {
        if (!std::isfinite(x)) x = x > 0.0f ? kLargestHalf : 0.0f;
        fits = fits && std::abs(x) <= kLargestHalf;
    }
    return fits;
}

/// Pixels of `to` channels from those of `from`: of grey and alpha, colours with alpha.
template <typename Number>
std::vector<Number> with_channels(const std::vector<Number>& numbers, size_t from, size_t to) {
    const size_t count = numbers.size() / from;
    std::vector<Number> result(count * to);
    for (size_t i = 0; i < count; ++i)
        for (size_t c = 0; c < to; ++c) {
            const size_t source = from == 2 ? (c == 3 ? 1 : 0) : c;
            result[i * to + c] = numbers[i * from + source];
        }
    return result;
}

}  // namespace

void make_room(std::vector<float>& pixels, size_t count, const CancelToken& cancel) {
    constexpr size_t kPart = size_t{1} << 20;
    pixels.reserve(count);
    while (pixels.size() < count) {
        cancel.throw_if_cancelled();
        pixels.resize(std::min(count, pixels.size() + kPart));
    }
}

void normalize_channels(Picture& picture, ImageAlpha alpha) {
    const bool is_opaque = alpha == ImageAlpha::Ignored;
    const int from = picture.channels;
    const int to = from == 2 ? (is_opaque ? 1 : 4) : std::min(from, is_opaque ? 3 : 4);
    if (from == to) return;
    picture.bytes = with_channels(picture.bytes, static_cast<size_t>(from), static_cast<size_t>(to));
    picture.pixels = with_channels(picture.pixels, static_cast<size_t>(from), static_cast<size_t>(to));
    picture.channels = to;
}

void prepare(Picture& picture, const ImageColors& colors, const CancelToken& cancel) {
    static const SrgbDecoder decode;
    const Linearizing linearize{decode, colors.space, picture.alpha, picture.channels, picture.alpha_channel()};
    const auto channels = static_cast<size_t>(picture.channels);
    const size_t length = picture.row();
    const bool is_plain = colors.space == ColorSpace::Srgb && linearize.alpha_channel < 0 && !colors.transform;
    make_room(picture.pixels, picture.count(), cancel);
    picture.prepared.resize(static_cast<size_t>(picture.height));
    tbb::parallel_for(size_t{0}, picture.prepared.size(), [&](size_t y) {
        cancel.throw_if_cancelled();
        if (picture.prepared[y] != 0) return;
        const std::span<float> row(&picture.pixels[y * length], length);
        if (!picture.bytes.empty()) {
            const std::span<const uint8_t> bytes(&picture.bytes[y * length], length);
            if (is_plain) {
                std::ranges::transform(bytes, row.begin(), [](uint8_t byte) { return decode.of_byte(byte); });
                picture.prepared[y] = 1;
                return;
            }
            std::ranges::transform(bytes, row.begin(), from_byte);
        }
        if (colors.transform) transform_row(*colors.transform, row, picture);
        if (colors.space == ColorSpace::Srgb && linearize.alpha_channel < 0)
            std::ranges::transform(row, row.begin(), [](float x) { return decode(x); });
        else if (colors.space != ColorSpace::NonColor)
            for (size_t i = 0; i < length; i += channels) linearize(&row[i]);
        if (!make_finite(row)) std::atomic_ref(picture.precise).store(true, std::memory_order_relaxed);
        picture.prepared[y] = 1;
    });
    picture.bytes = {};
}

}  // namespace rayleaf
