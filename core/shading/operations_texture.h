// Procedural textures and image lookups.
#pragma once

#include "base/vector.h"
#include "shading/inputs.h"
#include "shading/operation.h"

#include <cstdint>
#include <span>

namespace rayleaf {

/// 1 in the cells of colour 1, 0 in those of colour 2; unit cells.
inline float checker_value(const Vec3f& position) {
    // Blender's shift keeps faces that lie exactly on a border from flickering.
    const Vec3f p = (position + Vec3f(1e-6f)) * 0.999999f;
    const auto odd = [](float x) {
        constexpr float kAllEven = 0x1p24f;  // from here on, floats are
        const float near = std::abs(x) < kAllEven ? x : 0.0f;
        const int towards_zero = static_cast<int>(near);
        return (towards_zero - (near < static_cast<float>(towards_zero) ? 1 : 0)) & 1;
    };
    return static_cast<float>(odd(p.x) ^ odd(p.y) ^ odd(p.z));
}

/// A lookup coordinate and its change per pixel step.
struct CoordinateFootprint {
    Vec3f value, dx, dy;
};

/// Value of `image` (coordinate: u, v) or `environment` (coordinate: direction). Without textures: 0.
Vec4f image_value(Operation operation, std::span<const int32_t> ints, const CoordinateFootprint& coordinate,
                  const ShadingInputs& inputs);

/// Blender's box projection: u and v of the side across `axis` (0..2), and in w its share, for a surface with `normal`
/// in the box's space. `blend` 0..1: how far sides run into each other.
Vec4f box_projection(const Vec3f& position, const Vec3f& normal, float blend, int axis);

/// Picture coordinates, 0..1, of a direction, as Blender maps them. An equirectangular picture has +x in its middle, +y
/// a quarter to the left, +z on top; a mirror ball is looked at along +y.
Vec2f equirectangular(const Vec3f& direction);
Vec2f mirror_ball(const Vec3f& direction);

}  // namespace rayleaf
