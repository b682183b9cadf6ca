#include "scene/panorama.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>

namespace rayleaf {
namespace {

constexpr double kFullCircle = 2.0 * std::numbers::pi;

/// At `angle` from the view axis, towards (x, y) on the picture.
Vec3d around_axis(double angle, const Vec2d& towards) {
    const double length = std::hypot(towards.x, towards.y);
    if (length == 0.0) return {0.0, 0.0, -1.0};
    const double aside = std::sin(angle) / length;
    return {towards.x * aside, towards.y * aside, -std::cos(angle)};
}

Vec3d equirectangular(const Panorama& p, const Vec2d& place) {
    const double longitude = p.longitude_min + (p.longitude_max - p.longitude_min) * place.x;
    const double latitude = p.latitude_min + (p.latitude_max - p.latitude_min) * place.y;
    const double across = std::cos(latitude);
    return {across * std::sin(longitude), std::sin(latitude), -across * std::cos(longitude)};
}

std::optional<Vec3d> equidistant(const Panorama& p, const Vec2d& place) {
    const Vec2d from_middle = (place - Vec2d(0.5, 0.5)) * 2.0;
    const double radius = std::hypot(from_middle.x, from_middle.y);
    if (radius > 1.0) return std::nullopt;
    return around_axis(radius * p.field_of_view * 0.5, from_middle);
}

std::optional<Vec3d> equisolid(const Panorama& p, const Vec2d& place) {
    const Vec2d on_sensor((place.x - 0.5) * p.sensor_width, (place.y - 0.5) * p.sensor_height);
    const double radius = std::hypot(on_sensor.x, on_sensor.y);
    if (radius > 2.0 * p.lens * std::sin(p.field_of_view * 0.25)) return std::nullopt;
    return around_axis(2.0 * std::asin(std::min(radius / (2.0 * p.lens), 1.0)), on_sensor);
}

std::optional<Vec3d> mirror_ball(const Vec2d& place) {
    const Vec2d on_ball = (place - Vec2d(0.5, 0.5)) * 2.0;
    const double square = on_ball.x * on_ball.x + on_ball.y * on_ball.y;
    if (square > 1.0) return std::nullopt;
    // The ball's normal there, which faces who looks, and the way on from it.
    const double towards = std::sqrt(1.0 - square);
    return Vec3d(2.0 * towards * on_ball.x, 2.0 * towards * on_ball.y, 2.0 * towards * towards - 1.0) * Vec3d(1, 1, -1);
}

void require_range(const char* argument, double value, double least, double most) {
    if (!(value >= least && value <= most))
        throw InputError("camera", argument, number_text(value),
                         "a number from " + number_text(least) + " to " + number_text(most));
}

}  // namespace

void validate(const Panorama& p) {
    constexpr double kRight = std::numbers::pi / 2 * (1.0 + 1e-6), kWidest = 10.0 * std::numbers::pi;
    constexpr double kLeast = 1e-6, kMost = 1e6;
    require_range("longitude minimum", p.longitude_min, -kFullCircle, kFullCircle);
    require_range("longitude maximum", p.longitude_max, -kFullCircle, kFullCircle);
    require_range("latitude minimum", p.latitude_min, -kRight, kRight);
    require_range("latitude maximum", p.latitude_max, -kRight, kRight);
    require_range("field of view", p.field_of_view, kLeast, kWidest);
    require_range("fisheye lens", p.lens, kLeast, kMost);
    require_range("sensor width", p.sensor_width, kLeast, kMost);
    require_range("sensor height", p.sensor_height, kLeast, kMost);
    require_range("eye offset", p.stereo.offset, -kMost, kMost);
    if (p.stereo.convergence) require_range("convergence distance", *p.stereo.convergence, kLeast, 1e100);
    if (!p.stereo.pole_merge) return;
    require_range("start of the pole merge", p.stereo.pole_merge->first, 0.0, kRight);
    require_range("end of the pole merge", p.stereo.pole_merge->second, 0.0, kRight);
}

std::optional<Vec3d> panorama_direction(const Panorama& panorama, const Vec2d& place) {
    switch (panorama.kind) {
        case PanoramaKind::FisheyeEquidistant:
            return equidistant(panorama, place);
        case PanoramaKind::FisheyeEquisolid:
            return equisolid(panorama, place);
        case PanoramaKind::MirrorBall:
            return mirror_ball(place);
        case PanoramaKind::Equirectangular:
            break;
    }
    return equirectangular(panorama, place);
}

Vec2d panorama_place(const Panorama& panorama, const Vec3d& direction) {
    const Vec3d d = normalized_or(direction, Vec3d(0, 0, -1));
    const Vec2d aside = Vec2d(d.x, d.y) / std::max(std::hypot(d.x, d.y), 1e-300), middle(0.5, 0.5);
    const double angle = std::acos(std::clamp(-d.z, -1.0, 1.0));
    switch (panorama.kind) {
        case PanoramaKind::FisheyeEquidistant:
            return middle + aside * (angle / panorama.field_of_view);
        case PanoramaKind::FisheyeEquisolid: {
            const double radius = 2.0 * panorama.lens * std::sin(0.5 * angle);
            return middle + Vec2d(aside.x * radius / panorama.sensor_width, aside.y * radius / panorama.sensor_height);
        }
        case PanoramaKind::MirrorBall: {
            const Vec3d normal = normalized_or(Vec3d(d.x, d.y, 1.0 - d.z), Vec3d(0, 0, 1));
            return middle + Vec2d(normal.x, normal.y) * 0.5;
        }
        case PanoramaKind::Equirectangular:
            break;
    }
    const double longitude = std::atan2(d.x, -d.z), latitude = std::asin(std::clamp(d.y, -1.0, 1.0));
    return {(longitude - panorama.longitude_min) / (panorama.longitude_max - panorama.longitude_min),
            (latitude - panorama.latitude_min) / (panorama.latitude_max - panorama.latitude_min)};
}

double panorama_pixel_angle(const Panorama& p, int width, int height) {
    double across = kFullCircle, up = kFullCircle;
    switch (p.kind) {
        case PanoramaKind::FisheyeEquidistant:
            across = up = p.field_of_view;
            break;
        case PanoramaKind::FisheyeEquisolid:
            across = p.sensor_width / p.lens;
            up = p.sensor_height / p.lens;
            break;
        case PanoramaKind::MirrorBall:
            across = up = 4.0;  // in its middle
            break;
        case PanoramaKind::Equirectangular:
            across = std::abs(p.longitude_max - p.longitude_min);
            up = std::abs(p.latitude_max - p.latitude_min);
            break;
    }
    constexpr double kLeastAngle = 1e-9;
    return std::max(std::min(across / width, up / height), kLeastAngle);
}

}  // namespace rayleaf
