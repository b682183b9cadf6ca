#include "shading/operations_texture.h"

#include "textures/texture_store.h"

namespace rayleaf {

float checker_value(const Vec3f& position) {
    // Blender's shift keeps faces that lie exactly on a border from flickering.
    const Vec3f p = (position + Vec3f(1e-6f)) * 0.999999f;
    const auto odd = [](float x) {
        const float cell = std::floor(x);
        return cell - 2.0f * std::floor(cell * 0.5f) != 0.0f;
    };
    return (odd(p.x) == odd(p.y)) == odd(p.z) ? 1.0f : 0.0f;
}

Vec2f equirectangular(const Vec3f& direction) {
    if (direction == Vec3f(0.0f)) return {0.0f, 0.0f};
    const float u = -std::atan2(direction.y, direction.x) / (2.0f * kPi) + 0.5f;
    const float v = std::atan2(direction.z, std::hypot(direction.x, direction.y)) / kPi + 0.5f;
    return {u, v};
}

Vec2f mirror_ball(const Vec3f& direction) {
    const Vec3f unit = normalized_or(direction, Vec3f(0.0f, -1.0f, 0.0f));
    const float radius = 2.0f * std::sqrt(std::max(-0.5f * (unit.y - 1.0f), 0.0f));
    if (radius == 0.0f) return {0.5f, 0.5f};
    return {0.5f * (unit.x / radius + 1.0f), 0.5f * (unit.z / radius + 1.0f)};
}

namespace {

enum class Projection : int32_t { Equirectangular, MirrorBall };

Vec4f environment_value(const TextureStore& textures, std::span<const int32_t> ints,
                        const CoordinateFootprint& direction) {
    const auto projection = static_cast<Projection>(ints.size() > 1 ? ints[1] : 0);
    const auto interpolation = static_cast<TextureInterpolation>(ints.size() > 2 ? ints[2] : 0);
    const bool ball = projection == Projection::MirrorBall;
    const auto project = ball ? mirror_ball : equirectangular;
    const Vec2f uv = project(direction.value);
    const auto change = [&](const Vec3f& step) {
        return is_black(step) ? Vec2f(0.0f) : project(direction.value + step) - uv;
    };
    Vec2f dx = change(direction.dx), dy = change(direction.dy);
    if (!ball) {  // a step across the seam at -x is a small one
        dx.x -= std::round(dx.x);
        dy.x -= std::round(dy.x);
    }
    const TextureExtension extension = ball ? TextureExtension::Repeat : TextureExtension::Panorama;
    return textures.lookup(ints[0], uv, dx, dy, extension, interpolation);
}

}  // namespace

Vec4f image_value(Operation operation, std::span<const int32_t> ints, const CoordinateFootprint& coordinate,
                  const ShadingInputs& inputs) {
    if (inputs.textures == nullptr) return Vec4f(0.0f, 0.0f, 0.0f, 0.0f);
    if (operation == Operation::environment) return environment_value(*inputs.textures, ints, coordinate);
    const auto extension = static_cast<TextureExtension>(ints.size() > 1 ? ints[1] : 0);
    const auto interpolation = static_cast<TextureInterpolation>(ints.size() > 2 ? ints[2] : 0);
    const auto plane = [](const Vec3f& v) { return Vec2f(v.x, v.y); };
    return inputs.textures->lookup(ints[0], plane(coordinate.value), plane(coordinate.dx), plane(coordinate.dy),
                                   extension, interpolation);
}

}  // namespace rayleaf
