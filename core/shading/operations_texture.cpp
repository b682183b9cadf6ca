#include "shading/operations_texture.h"

#include "shading/operands.h"
#include "textures/texture_store.h"

#include <optional>

namespace rayleaf {

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

/// From an operation's third number.
TextureReading reading_of(std::span<const int32_t> ints) {
    constexpr int32_t kMultiplied = 4;
    const int32_t number = ints.size() > 2 ? ints[2] : 0;
    return {static_cast<TextureInterpolation>(std::min(number & (kMultiplied - 1), 2)), (number & kMultiplied) != 0};
}

Vec4f environment_value(const TextureStore& textures, std::span<const int32_t> ints,
                        const CoordinateFootprint& direction) {
    const auto projection = static_cast<Projection>(ints.size() > 1 ? ints[1] : 0);
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
    return textures.lookup(ints[0], uv, dx, dy, extension, reading_of(ints));
}

enum class ImageProjection : int32_t { Flat, Sphere, Tube };

struct PlaneFootprint {
    Vec2f value, dx, dy;
};

/// Around the picture's middle, 0.5 in all three, once around a turn.
Vec2f sphere_coordinate(const Vec3f& p) {
    const float length = p.length();
    if (!(length > 0.0f)) return {0.0f, 0.0f};
    const float u = p.x == 0.0f && p.y == 0.0f ? 0.0f : 0.5f * (1.0f - std::atan2(p.x, p.y) / kPi);
    return {u, 1.0f - std::acos(std::clamp(p.z / length, -1.0f, 1.0f)) / kPi};
}
Vec2f tube_coordinate(const Vec3f& p) {
    if (p.x == 0.0f && p.y == 0.0f) return {0.0f, 0.0f};
    return {0.5f * (1.0f - std::atan2(p.x, p.y) / kPi), 0.5f * (p.z + 1.0f)};
}

PlaneFootprint on_plane(ImageProjection projection, const CoordinateFootprint& coordinate) {
    if (projection == ImageProjection::Flat) {
        const auto plane = [](const Vec3f& v) { return Vec2f(v.x, v.y); };
        return {plane(coordinate.value), plane(coordinate.dx), plane(coordinate.dy)};
    }
    const auto project = [projection](const Vec3f& p) {
        const Vec3f centered = p * 2.0f - Vec3f(1.0f);
        return projection == ImageProjection::Sphere ? sphere_coordinate(centered) : tube_coordinate(centered);
    };
    PlaneFootprint result{project(coordinate.value), project(coordinate.value + coordinate.dx),
                          project(coordinate.value + coordinate.dy)};
    for (Vec2f* step : {&result.dx, &result.dy}) {
        *step -= result.value;
        step->x -= std::round(step->x);  // across the seam
    }
    return result;
}

struct UdimPlace {
    int32_t texture;
    Vec2f uv;  ///< within the tile
};

/// Blender's pink for what is missing.
const Vec4f kMissingTile(1.0f, 0.0f, 1.0f, 1.0f);

/// `tiles`: numbers and texture ids in turn. Tiles stand in rows of ten, the first is 1001.
std::optional<UdimPlace> udim_place(std::span<const int32_t> tiles, const Vec2f& uv) {
    constexpr float kRow = 10.0f, kFirst = 1001.0f;
    const Vec2f corner(std::floor(uv.x), std::floor(uv.y));
    if (!(corner.x >= 0.0f && corner.x < kRow && corner.y >= 0.0f && corner.y < 100.0f)) return std::nullopt;
    const auto number = static_cast<int32_t>(kFirst + corner.x + kRow * corner.y);
    for (size_t i = 0; i + 1 < tiles.size(); i += 2)
        if (tiles[i] == number) return UdimPlace{tiles[i + 1], uv - corner};
    return std::nullopt;
}

}  // namespace

namespace {

/// How much each of three sides shows. `n` are the normal's components without sign, of sum 1. The triangle of all such
/// normals has a corner for each side, where it shows alone, strips along its edges where two mix, and a middle of
/// three.
Vec3f box_shares(const Vec3f& n, float blend) {
    const float limit = 0.5f * (1.0f + blend);
    for (int i = 0; i < 3; ++i) {
        const float one = n[i], next = n[(i + 1) % 3], last = n[(i + 2) % 3];
        if (one > limit * (one + next) && one > limit * (one + last)) {
            Vec3f shares(0.0f);
            shares[i] = 1.0f;
            return shares;
        }
    }
    if (!(blend > 0.0f)) return {1.0f, 0.0f, 0.0f};
    for (const int least : {2, 0, 1}) {
        const int a = least == 0 ? 1 : 0, b = least == 2 ? 1 : 2;
        if (!(n[least] < (1.0f - limit) * (n[a] + n[b]))) continue;
        Vec3f shares(0.0f);
        shares[a] = saturate((n[a] / (n[a] + n[b]) - 0.5f * (1.0f - blend)) / blend);
        shares[b] = 1.0f - shares[a];
        return shares;
    }
    return (n * (2.0f - limit) + Vec3f(limit - 1.0f)) / (2.0f * limit - 1.0f);
}

}  // namespace

Vec4f box_projection(const Vec3f& p, const Vec3f& normal, float blend, int axis) {
    const float sum = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
    const Vec3f n = sum > 0.0f && std::isfinite(sum)
                        ? Vec3f(std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)) / sum
                        : Vec3f(0.0f, 0.0f, 1.0f);
    const float share = box_shares(n, saturate(blend))[axis];
    switch (axis) {
        case 0:
            return Vec4f(normal.x < 0.0f ? 1.0f - p.y : p.y, p.z, 0.0f, share);
        case 1:
            return Vec4f(normal.y > 0.0f ? 1.0f - p.x : p.x, p.z, 0.0f, share);
        default:
            return Vec4f(normal.z > 0.0f ? 1.0f - p.y : p.y, p.x, 0.0f, share);
    }
}

Vec4f image_value(Operation operation, std::span<const int32_t> ints, const CoordinateFootprint& coordinate,
                  const ShadingInputs& inputs) {
    if (inputs.textures == nullptr) return Vec4f(0.0f, 0.0f, 0.0f, 0.0f);
    if (operation == Operation::environment) return environment_value(*inputs.textures, ints, coordinate);
    const auto extension = static_cast<TextureExtension>(ints.size() > 1 ? ints[1] : 0);
    const TextureReading reading = reading_of(ints);
    const PlaneFootprint at = on_plane(static_cast<ImageProjection>(ints.size() > 3 ? ints[3] : 0), coordinate);
    const auto value = [&](TextureId texture, const Vec2f& uv, TextureExtension beyond) {
        return inputs.textures->lookup(texture, uv, at.dx, at.dy, beyond, reading);
    };
    if (ints.size() <= 4) return value(ints[0], at.value, extension);
    const std::optional<UdimPlace> place = udim_place(ints.subspan(4), at.value);
    if (!place) return kMissingTile;
    // Within a tile there is nothing to repeat.
    return value(place->texture, place->uv, TextureExtension::Extend);
}

}  // namespace rayleaf
