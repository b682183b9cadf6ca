#include "shading/patterns.h"

#include "shading/lattice_hash.h"
#include "shading/noise.h"

namespace rayleaf {
namespace {

constexpr float kTurn = 2.0f * kPi;

float smooth_step(float x) {
    return x * x * (3.0f - 2.0f * x);
}

}  // namespace

float gradient_texture(GradientVariant variant, const Vec3f& p) {
    // Blender's shift: less than one, so that what should be 0 outside is.
    const float inside = std::max(0.999999f - p.length(), 0.0f);
    const float positive = std::max(p.x, 0.0f);
    float value = 0.0f;
    switch (variant) {
        case GradientVariant::LINEAR:
            value = p.x;
            break;
        case GradientVariant::QUADRATIC:
            value = positive * positive;
            break;
        case GradientVariant::EASING:
            value = smooth_step(std::min(positive, 1.0f));
            break;
        case GradientVariant::DIAGONAL:
            value = 0.5f * (p.x + p.y);
            break;
        case GradientVariant::SPHERICAL:
            value = inside;
            break;
        case GradientVariant::QUADRATIC_SPHERE:
            value = inside * inside;
            break;
        case GradientVariant::RADIAL:
            value = std::atan2(p.y, p.x) / kTurn + 0.5f;
            break;
    }
    return std::clamp(value, 0.0f, 1.0f);
}

namespace {

float wave_phase(const Vec3f& p, const WaveParameters& parameters) {
    constexpr float kWaves = 20.0f;  // radians of a wave per unit
    const float along[3] = {p.x, p.y, p.z};
    const auto axis = static_cast<size_t>(parameters.axis);
    if (parameters.shape == WaveShape::Bands)
        return parameters.axis == WaveAxis::Diagonal ? (p.x + p.y + p.z) * (0.5f * kWaves) : along[axis] * kWaves;
    Vec3f around = p;
    if (parameters.axis != WaveAxis::Diagonal) around[static_cast<int>(axis)] = 0.0f;
    return around.length() * kWaves;
}

}  // namespace

float wave_texture(const Vec3f& position, const WaveParameters& parameters) {
    // Blender's shift keeps faces that lie exactly on a border from flickering.
    const Vec3f p = (position + Vec3f(1e-6f)) * 0.999999f;
    float phase = wave_phase(p, parameters) + parameters.phase;
    if (parameters.distortion != 0.0f) {
        NoiseParameters noise;
        noise.detail = parameters.detail;
        noise.roughness = parameters.detail_roughness;
        const Vec3f q = p * parameters.detail_scale;
        phase += parameters.distortion *
                 (noise_texture(3, Vec4f(q.x, q.y, q.z, 0.0f), noise, NoiseChannels::Factor).x * 2.0f - 1.0f);
    }
    const float turns = phase / kTurn;
    switch (parameters.profile) {
        case WaveProfile::SIN:
            return 0.5f + 0.5f * std::sin(phase - 0.5f * kPi);
        case WaveProfile::SAW:
            return turns - std::floor(turns);
        case WaveProfile::TRI:
            return std::abs(turns - std::floor(turns + 0.5f)) * 2.0f;
    }
    return 0.0f;
}

namespace {

/// As an integer, which what is too large for one is not.
int32_t whole(float x) {
    constexpr float kLargest = 2147483520.0f;  // the largest float below 2^31
    const float floor = std::floor(x);
    return std::abs(floor) <= kLargest ? static_cast<int32_t>(floor) : 0;
}

/// 0..1 by an integer, by the polynomial that many noises of integers use.
float integer_noise(uint32_t n) {
    n = (n + 1013u) & 0x7fffffffu;
    n = (n >> 13) ^ n;
    const uint32_t mixed = (n * (n * n * 60493u + 19990303u) + 1376312589u) & 0x7fffffffu;
    return 0.5f * (static_cast<float>(mixed) / 1073741824.0f);
}

float mortar_at(float to_border, const BrickParameters& parameters) {
    if (to_border >= parameters.mortar_size) return 0.0f;
    if (parameters.mortar_smooth == 0.0f) return 1.0f;
    const float depth = 1.0f - to_border / parameters.mortar_size;
    return depth < parameters.mortar_smooth ? smooth_step(std::max(depth / parameters.mortar_smooth, 0.0f)) : 1.0f;
}

}  // namespace

BrickResult brick_texture(const Vec3f& p, const BrickParameters& parameters) {
    const int32_t row = whole(p.y / parameters.height);
    float width = parameters.width, offset = 0.0f;
    if (parameters.offset_every != 0 && parameters.squash_every != 0) {
        if (row % parameters.squash_every == 0) width *= parameters.squash;
        if (row % parameters.offset_every == 0) offset = width * parameters.offset;
    }
    const int32_t column = whole((p.x + offset) / width);
    const float x = p.x + offset - width * static_cast<float>(column);
    const float y = p.y - parameters.height * static_cast<float>(row);
    const float noise = integer_noise((static_cast<uint32_t>(row) << 16) + (static_cast<uint32_t>(column) & 0xffffu));
    const float to_border = std::min(std::min(x, y), std::min(width - x, parameters.height - y));
    return {std::clamp(noise + parameters.bias, 0.0f, 1.0f), mortar_at(to_border, parameters)};
}

Color magic_texture(const Vec3f& p, int depth, float distortion) {
    // Sines repeat; what is far away would lose their period.
    const float a = std::fmod(p.x, kTurn), b = std::fmod(p.y, kTurn), c = std::fmod(p.z, kTurn);
    float x = std::sin((a + b + c) * 5.0f), y = std::cos((-a + b - c) * 5.0f), z = -std::cos((-a - b + c) * 5.0f);
    const float d = distortion;
    if (depth > 0) {
        x *= d;
        y = -std::cos(x - y * d + z * d) * d;
        z *= d;
    }
    if (depth > 1) x = std::cos(x - y - z) * d;
    if (depth > 2) z = std::sin(-x - y - z) * d;
    if (depth > 3) x = -std::cos(-x + y - z) * d;
    if (depth > 4) y = -std::sin(-x + y + z) * d;
    if (depth > 5) y = -std::cos(-x + y + z) * d;
    if (depth > 6) x = std::cos(x + y + z) * d;
    if (depth > 7) z = std::sin(x + y - z) * d;
    if (depth > 8) x = -std::cos(-x - y + z) * d;
    if (depth > 9) y = -std::sin(x - y + z) * d;
    return Color(0.5f) - Color(x, y, z) / (d == 0.0f ? 1.0f : 2.0f * d);
}

Color white_noise(int dimensions, const Vec4f& p) {
    switch (dimensions) {
        case 1:
            return {unit_hash(p.w), unit_hash(p.w, 1.0f), unit_hash(p.w, 2.0f)};
        case 2:
            return {unit_hash(p.x, p.y), unit_hash(p.x, p.y, 1.0f), unit_hash(p.x, p.y, 2.0f)};
        case 3:
            return {unit_hash(p.x, p.y, p.z), unit_hash(p.x, p.y, p.z, 1.0f), unit_hash(p.x, p.y, p.z, 2.0f)};
        default:
            return {unit_hash(p.x, p.y, p.z, p.w), unit_hash(p.z, p.x, p.w, p.y), unit_hash(p.w, p.z, p.y, p.x)};
    }
}

}  // namespace rayleaf
