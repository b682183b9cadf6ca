#include "shading/operations_pattern.h"

#include "shading/fractals.h"
#include "shading/gabor.h"
#include "shading/noise.h"
#include "shading/operations_texture.h"
#include "shading/patterns.h"
#include "shading/variants.h"
#include "shading/voronoi.h"

namespace rayleaf {
namespace {

/// The first operand, a coordinate.
Vec3f coordinate3(const Operands& operands, float scale) {
    const Vec3f p = operands.vector(0) * scale;
    return {sound_coordinate(p.x), sound_coordinate(p.y), sound_coordinate(p.z)};
}

/// A coordinate of four dimensions: `vector` and `w`, the first two operands.
Vec4f coordinate(const Operands& operands, float scale) {
    const Vec3f p = coordinate3(operands, scale);
    return Vec4f(p.x, p.y, p.z, sound_coordinate(operands.scalar(1) * scale));
}

Vec4f checker(const Operands& operands) {
    const float factor = checker_value(coordinate3(operands, operands.scalar(3)));
    return extended(factor == 1.0f ? operands.vector(1) : operands.vector(2), factor);
}

Vec4f noise(NoiseUse use, const Operands& operands, std::span<const int32_t> ints) {
    NoiseParameters parameters;
    parameters.detail = operands.scalar(3);
    parameters.roughness = operands.scalar(4);
    parameters.distortion = operands.scalar(5);
    parameters.lacunarity = operands.scalar(6, 2.0f);
    parameters.offset = operands.scalar(7);
    parameters.gain = operands.scalar(8, 1.0f);
    parameters.normalize = ints.size() < 2 || ints[1] != 0;
    parameters.type = ints.size() < 3 ? FractalType::FBM : static_cast<FractalType>(ints[2]);
    const NoiseChannels channels = use == NoiseUse::Factor ? NoiseChannels::Factor : NoiseChannels::All;
    const Vec3f color = noise_texture(ints[0], coordinate(operands, operands.scalar(2)), parameters, channels);
    return extended(color, color.x);
}

Vec4f musgrave(FractalType type, const Operands& operands, int dimensions) {
    FractalParameters parameters;
    parameters.lacunarity = operands.scalar(5);
    parameters.offset = operands.scalar(6);
    parameters.gain = operands.scalar(7);
    return spread(musgrave_texture(dimensions, type, coordinate(operands, operands.scalar(2)), operands.scalar(3),
                                   operands.scalar(4), parameters));
}

Vec4f voronoi(VoronoiFeature feature, const Operands& operands, std::span<const int32_t> ints) {
    const float scale = operands.scalar(2);
    const bool normalize = ints.size() > 3 && ints[3] != 0;
    const VoronoiParameters parameters{feature,
                                       static_cast<VoronoiMetric>(ints[1]),
                                       operands.scalar(4),
                                       operands.scalar(3),
                                       operands.scalar(5),
                                       operands.scalar(6),
                                       operands.scalar(7, 0.5f),
                                       operands.scalar(8, 2.0f),
                                       normalize,
                                       static_cast<VoronoiHash>(ints.size() > 4 ? ints[4] : 0)};
    const VoronoiResult result = voronoi_texture(ints[0], coordinate(operands, scale), parameters);
    if (ints[2] == 0) return extended(result.color, result.distance);
    return scale != 0.0f ? result.place / scale : spread(0.0f);
}

Vec4f wave(WaveProfile profile, const Operands& operands, std::span<const int32_t> ints) {
    WaveParameters parameters;
    parameters.shape = static_cast<WaveShape>(ints[0]);
    parameters.axis = static_cast<WaveAxis>(ints[1]);
    parameters.profile = profile;
    parameters.distortion = operands.scalar(2);
    parameters.detail = operands.scalar(3);
    parameters.detail_scale = operands.scalar(4);
    parameters.detail_roughness = operands.scalar(5);
    parameters.phase = operands.scalar(6);
    return spread(wave_texture(coordinate3(operands, operands.scalar(1)), parameters));
}

Vec4f magic(const Operands& operands, int depth) {
    const Color color = magic_texture(coordinate3(operands, operands.scalar(1)), depth, operands.scalar(2));
    return extended(color, (color.x + color.y + color.z) / 3.0f);
}

Vec4f brick(const Operands& operands, std::span<const int32_t> ints) {
    BrickParameters parameters;
    parameters.mortar_size = operands.scalar(5);
    parameters.mortar_smooth = operands.scalar(6);
    parameters.bias = operands.scalar(7);
    parameters.width = operands.scalar(8);
    parameters.height = operands.scalar(9);
    parameters.offset = operands.scalar(10);
    parameters.squash = operands.scalar(11);
    parameters.offset_every = ints[0];
    parameters.squash_every = ints[1];
    const BrickResult result = brick_texture(coordinate3(operands, operands.scalar(4)), parameters);
    const auto mixed = [](const Color& a, const Color& b, float share) { return a * (1.0f - share) + b * share; };
    const Color stone = mixed(operands.vector(1), operands.vector(2), result.tint);
    return extended(mixed(stone, operands.vector(3), result.mortar), result.mortar);
}

/// What waves cannot have counts as 0.
Vec4f gabor(const Operands& operands, int dimensions) {
    const Vec3f direction = operands.vector(5);
    GaborParameters parameters;
    parameters.frequency = sound_coordinate(operands.scalar(2));
    parameters.anisotropy = sound_coordinate(operands.scalar(3));
    parameters.orientation = sound_coordinate(operands.scalar(4));
    parameters.direction = {sound_coordinate(direction.x), sound_coordinate(direction.y),
                            sound_coordinate(direction.z)};
    const GaborResult result = gabor_texture(dimensions, coordinate3(operands, operands.scalar(1)), parameters);
    return Vec4f(result.value, result.phase, result.intensity, 1.0f);
}

}  // namespace

Vec4f pattern_value(Operation operation, uint8_t variant, const Operands& operands, std::span<const int32_t> ints) {
    switch (operation) {
        case Operation::checker:
            return checker(operands);
        case Operation::noise:
            return noise(static_cast<NoiseUse>(variant), operands, ints);
        case Operation::musgrave:
            return musgrave(static_cast<FractalType>(variant), operands, ints[0]);
        case Operation::voronoi:
            return voronoi(static_cast<VoronoiFeature>(variant), operands, ints);
        case Operation::white_noise: {
            const Color color = white_noise(ints[0], coordinate(operands, 1.0f));
            return extended(color, color.x);
        }
        case Operation::gradient:
            return spread(gradient_texture(static_cast<GradientVariant>(variant), coordinate3(operands, 1.0f)));
        case Operation::wave:
            return wave(static_cast<WaveProfile>(variant), operands, ints);
        case Operation::magic:
            return magic(operands, ints[0]);
        case Operation::brick:
            return brick(operands, ints);
        case Operation::gabor:
            return gabor(operands, ints[0]);
        default:
            return spread(0.0f);
    }
}

}  // namespace rayleaf
