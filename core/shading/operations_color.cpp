#include "shading/operations_color.h"

#include "shading/operands.h"

namespace rayleaf {
namespace {

float mixed(float a, float b, float factor) {
    return a + (b - a) * factor;
}
Vec3f mixed(const Vec3f& a, const Vec3f& b, const Vec3f& factor) {
    return a + (b - a) * factor;
}

float burn(float t, float a, float b) {
    const float divisor = 1.0f - t + t * b;
    return divisor <= 0.0f ? 0.0f : saturate(1.0f - (1.0f - a) / divisor);
}
float dodge(float t, float a, float b) {
    if (a == 0.0f) return 0.0f;
    const float divisor = 1.0f - t * b;
    return divisor <= 0.0f ? 1.0f : std::min(a / divisor, 1.0f);
}
float overlay(float t, float a, float b) {
    if (a < 0.5f) return a * (1.0f - t + 2.0f * t * b);
    return 1.0f - (1.0f - t + 2.0f * t * (1.0f - b)) * (1.0f - a);
}
float soft_light(float t, float a, float b) {
    const float screen = 1.0f - (1.0f - b) * (1.0f - a);
    return (1.0f - t) * a + t * ((1.0f - a) * b * a + a * screen);
}

/// The blend types that treat each channel alone.
float blend_channel(BlendVariant variant, float t, float a, float b) {
    switch (variant) {
        case BlendVariant::MIX:
            return mixed(a, b, t);
        case BlendVariant::DARKEN:
            return mixed(a, std::min(a, b), t);
        case BlendVariant::MULTIPLY:
            return mixed(a, a * b, t);
        case BlendVariant::BURN:
            return burn(t, a, b);
        case BlendVariant::LIGHTEN:
            return mixed(a, std::max(a, b), t);
        case BlendVariant::SCREEN:
            return 1.0f - (1.0f - t + t * (1.0f - b)) * (1.0f - a);
        case BlendVariant::DODGE:
            return dodge(t, a, b);
        case BlendVariant::ADD:
            return mixed(a, a + b, t);
        case BlendVariant::OVERLAY:
            return overlay(t, a, b);
        case BlendVariant::SOFT_LIGHT:
            return soft_light(t, a, b);
        case BlendVariant::LINEAR_LIGHT:
            return a + t * (2.0f * b - 1.0f);
        case BlendVariant::DIFFERENCE:
            return mixed(a, std::abs(a - b), t);
        case BlendVariant::EXCLUSION:
            return std::max(mixed(a, a + b - 2.0f * a * b, t), 0.0f);
        case BlendVariant::SUBTRACT:
            return mixed(a, a - b, t);
        case BlendVariant::DIVIDE:
            return b != 0.0f ? (1.0f - t) * a + t * a / b : a;
        default:
            return a;
    }
}

/// The blend types that exchange coordinates of the HSV model.
Vec3f blend_model(BlendVariant variant, float t, const Vec3f& a, const Vec3f& b) {
    Vec3f own = rgb_to_hsv(a);
    const Vec3f other = rgb_to_hsv(b);
    switch (variant) {
        case BlendVariant::HUE:
            if (other.y == 0.0f) return a;
            return mixed(a, hsv_to_rgb({other.x, own.y, own.z}), Vec3f(t));
        case BlendVariant::SATURATION:
            if (own.y == 0.0f) return a;
            own.y = mixed(own.y, other.y, t);
            return hsv_to_rgb(own);
        case BlendVariant::COLOR:
            if (other.y == 0.0f) return a;
            return mixed(a, hsv_to_rgb({other.x, other.y, own.z}), Vec3f(t));
        default:
            own.z = mixed(own.z, other.z, t);
            return hsv_to_rgb(own);
    }
}

/// Hue, 0..1, of a colour whose largest channel exceeds its smallest by `range` > 0.
float hue_of(const Vec3f& rgb, float largest, float range) {
    float sextant = 0.0f;
    if (rgb.x == largest) {
        sextant = (rgb.y - rgb.z) / range;
    } else if (rgb.y == largest) {
        sextant = 2.0f + (rgb.z - rgb.x) / range;
    } else {
        sextant = 4.0f + (rgb.x - rgb.y) / range;
    }
    const float hue = sextant / 6.0f;
    return hue < 0.0f ? hue + 1.0f : hue;
}

/// The fully saturated colour of a hue in 0..1.
Vec3f pure_hue(float hue) {
    const float sextant = hue * 6.0f;
    return saturate(
        Vec3f(std::abs(sextant - 3.0f) - 1.0f, 2.0f - std::abs(sextant - 2.0f), 2.0f - std::abs(sextant - 4.0f)));
}

}  // namespace

Vec3f blend(BlendVariant variant, const Vec3f& factor, const Vec3f& a, const Vec3f& b) {
    switch (variant) {
        case BlendVariant::MIX:
            return mixed(a, b, factor);
        case BlendVariant::HUE:
        case BlendVariant::SATURATION:
        case BlendVariant::COLOR:
        case BlendVariant::VALUE:
            return blend_model(variant, factor.x, a, b);
        default:
            return {blend_channel(variant, factor.x, a.x, b.x), blend_channel(variant, factor.y, a.y, b.y),
                    blend_channel(variant, factor.z, a.z, b.z)};
    }
}

bool blend_rows(BlendVariant variant, size_t count, const float* factor, const float* a, const float* b,
                float* result) {
    const auto blend_all = [&](BlendVariant each) {
        for (size_t i = 0; i < count; ++i) result[i] = blend_channel(each, factor[i], a[i], b[i]);
    };
    switch (variant) {
        case BlendVariant::HUE:
        case BlendVariant::SATURATION:
        case BlendVariant::COLOR:
        case BlendVariant::VALUE:
            return false;
        // Named so that they become loops of their own.
        case BlendVariant::MIX:
            blend_all(BlendVariant::MIX);
            return true;
        case BlendVariant::MULTIPLY:
            blend_all(BlendVariant::MULTIPLY);
            return true;
        default:
            blend_all(variant);
            return true;
    }
}

Vec3f rgb_to_hsv(const Vec3f& rgb) {
    const float largest = max_component(rgb), smallest = std::min(rgb.x, std::min(rgb.y, rgb.z));
    const float range = largest - smallest;
    const float saturation = largest != 0.0f ? range / largest : 0.0f;
    const float hue = saturation != 0.0f ? hue_of(rgb, largest, range) : 0.0f;
    return {hue, saturation, largest};
}

Vec3f hsv_to_rgb(const Vec3f& hsv) {
    const float value = hsv.z;
    if (hsv.y == 0.0f) return Vec3f(value);
    const float turn = hsv.x == 1.0f ? 0.0f : hsv.x * 6.0f;
    const float sextant = std::floor(turn), rest = turn - sextant;
    const float low = value * (1.0f - hsv.y), falling = value * (1.0f - hsv.y * rest),
                rising = value * (1.0f - hsv.y * (1.0f - rest));
    if (sextant == 0.0f) return {value, rising, low};
    if (sextant == 1.0f) return {falling, value, low};
    if (sextant == 2.0f) return {low, value, rising};
    if (sextant == 3.0f) return {low, falling, value};
    if (sextant == 4.0f) return {rising, low, value};
    return {value, low, falling};  // hues outside 0..1 too, as in Cycles
}

Vec3f rgb_to_hsl(const Vec3f& rgb) {
    const float largest = max_component(rgb), smallest = std::min(rgb.x, std::min(rgb.y, rgb.z));
    const float lightness = std::min(1.0f, (largest + smallest) / 2.0f);
    const float range = largest - smallest;
    if (range == 0.0f) return {0.0f, 0.0f, lightness};
    const float saturation = lightness > 0.5f ? range / (2.0f - largest - smallest) : range / (largest + smallest);
    return {hue_of(rgb, largest, range), saturation, lightness};
}

Vec3f hsl_to_rgb(const Vec3f& hsl) {
    const float chroma = (1.0f - std::abs(2.0f * hsl.z - 1.0f)) * hsl.y;
    return (pure_hue(hsl.x) - Vec3f(0.5f)) * chroma + Vec3f(hsl.z);
}

Vec3f gamma_correct(const Vec3f& color, float gamma) {
    if (gamma == 0.0f) return Vec3f(1.0f);
    const auto power = [gamma](float x) { return x > 0.0f ? std::pow(x, gamma) : x; };
    return {power(color.x), power(color.y), power(color.z)};
}

Vec3f bright_contrast(const Vec3f& color, float bright, float contrast) {
    const float slope = 1.0f + contrast, offset = bright - contrast * 0.5f;
    const auto grade = [=](float x) { return std::max(slope * x + offset, 0.0f); };
    return {grade(color.x), grade(color.y), grade(color.z)};
}

Vec3f hue_saturation(const Vec3f& color, float hue, float saturation, float value, float factor) {
    Vec3f hsv = rgb_to_hsv(color);
    hsv.x += hue + 0.5f;
    hsv.x -= std::floor(hsv.x);
    hsv.y = saturate(hsv.y * saturation);
    hsv.z *= value;
    const Vec3f graded = mixed(color, hsv_to_rgb(hsv), Vec3f(factor));
    return {std::max(graded.x, 0.0f), std::max(graded.y, 0.0f), std::max(graded.z, 0.0f)};
}

Vec4f table_value(std::span<const float> entries, float x, bool linear) {
    const int last = static_cast<int>(entries.size() / 4) - 1;
    const auto entry = [&](int i) {
        const float* rgba = &entries[static_cast<size_t>(i) * 4];
        return Vec4f(rgba[0], rgba[1], rgba[2], rgba[3]);
    };
    const float position = (x > 0.0f ? std::min(x, 1.0f) : 0.0f) * static_cast<float>(last);  // NaN: the start
    const int i = std::min(static_cast<int>(position), last);
    const float share = position - static_cast<float>(i);
    if (!linear || i == last || share == 0.0f) return entry(i);
    return entry(i) * (1.0f - share) + entry(i + 1) * share;
}

}  // namespace rayleaf
