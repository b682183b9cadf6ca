#include "lights/area_lamp.h"

#include "lights/spherical_rectangle.h"

namespace rayleaf {
namespace {

/// Below this solid angle the density by area hardly varies, and the spherical rectangle would lose digits.
constexpr double kSmallestSphericalRectangle = 1e-3;
/// Lamps smaller than this (world units²) are points with a cosine.
constexpr double kSmallestArea = 1e-30;
constexpr double kRightAngle = 1e-6;  ///< cosine below which two edges count as orthogonal

}  // namespace

AreaLamp::AreaLamp(const Lamp& lamp)
    : center_(lamp.to_world.translation),
      x_(lamp.to_world.x * (0.5 * lamp.size_x)),
      y_(lamp.to_world.y * (0.5 * lamp.size_y)),
      intensity_(lamp.strength * 0.25f),
      ellipse_(lamp.kind == LampKind::Disk) {
    const Vec3d forward = normalized_or(-lamp.to_world.z, Vec3d(0, 0, -1));
    const Vec3d cross = x_.cross(y_);
    normal_ = normalized_or(cross, forward);
    if (normal_.dot(forward) < 0) normal_ = -normal_;
    area_ = cross.length() * (ellipse_ ? std::numbers::pi : 4.0);
    orthogonal_ = std::abs(x_.dot(y_)) <= kRightAngle * x_.length() * y_.length();
    const double half = 0.5 * std::clamp(lamp.spread, 0.0, std::numbers::pi);
    constexpr double kNarrowest = 1e-3;  // radians; Blender's spread slider ends at 1 degree
    if (half < 0.5 * std::numbers::pi - 1e-6) {
        const double angle = std::max(half, kNarrowest);
        // 2 * integral of (1 - tan x cot a) cos x sin x over 0..a is 1 - a cot a.
        cot_spread_ = 1.0 / std::tan(angle);
        gain_ = 1.0 / (1.0 - angle * cot_spread_);
    }
    if (area_ > kSmallestArea) radiance_ = Color(Vec3d(intensity_) / area_);
    if (!(area_ > kSmallestArea) || !is_usable(radiance_ * static_cast<float>(gain_))) area_ = 0;
}

float AreaLamp::attenuation(double cosine) const {
    if (!(cosine > 0)) return 0.0f;
    if (cot_spread_ == 0) return 1.0f;
    const double tangent = std::sqrt(std::max(0.0, 1.0 - cosine * cosine)) / cosine;
    return static_cast<float>(std::max(0.0, 1.0 - tangent * cot_spread_) * gain_);
}

double AreaLamp::intensity() const {
    return max_abs(intensity_) * gain_;
}

std::optional<AreaLamp::Window> AreaLamp::window(const Vec3d& position) const {
    Window window{-1, 1, -1, 1};
    if (cot_spread_ == 0 || !orthogonal_) return window;
    const Vec3d offset = position - center_;
    const double visible = offset.dot(normal_) / cot_spread_;
    const auto clip = [&](const Vec3d& axis, double& low, double& high) {
        const double at = offset.dot(axis) / axis.length2(), half = visible / axis.length();
        low = std::max(low, at - half);
        high = std::min(high, at + half);
        return low < high;
    };
    if (!clip(x_, window.x_min, window.x_max) || !clip(y_, window.y_min, window.y_max)) return std::nullopt;
    return window;
}

namespace {

/// An ellipse is sampled as a whole unless its window is the smaller of the two.
template <typename Window>
bool samples_whole_ellipse(const Window& w) {
    return (w.x_max - w.x_min) * (w.y_max - w.y_min) >= std::numbers::pi;
}

/// The window as a spherical rectangle, for a point above the lamp at `offset` from its centre.
template <typename Window>
SphericalRectangle spherical(const Window& w, const Vec3d& x, const Vec3d& y, const Vec3d& offset, double height) {
    const double x_length = x.length(), y_length = y.length();
    const double x_at = offset.dot(x) / x_length, y_at = offset.dot(y) / y_length;
    return {w.x_min * x_length - x_at, w.x_max * x_length - x_at, w.y_min * y_length - y_at, w.y_max * y_length - y_at,
            height};
}

}  // namespace

double AreaLamp::density(const Vec3d& position, const Vec3d& to) const {
    const std::optional<Window> w = window(position);
    if (!w) return 0;
    const Vec3d offset = to - position;
    const double height = (position - center_).dot(normal_);
    if (!(height > 0)) return 0;
    double share = (w->x_max - w->x_min) * (w->y_max - w->y_min) * x_.cross(y_).length();
    if (ellipse_ && samples_whole_ellipse(*w)) share = area_;
    if (!ellipse_ && orthogonal_) {
        const double solid_angle = spherical(*w, x_, y_, position - center_, height).solid_angle();
        if (solid_angle > kSmallestSphericalRectangle) return 1.0 / solid_angle;
    }
    const double distance_squared = offset.length2();
    const double cosine = height / std::sqrt(distance_squared);
    return std::min(kLargestDensity, distance_squared / (cosine * share));
}

std::optional<LampSample> AreaLamp::sample_by_area(const Vec3d& position, const Vec2f& random, const Window& w) const {
    double x = 0, y = 0;
    if (ellipse_ && samples_whole_ellipse(w)) {
        const double radius = std::sqrt(static_cast<double>(random.x));
        const double phi = 2.0 * std::numbers::pi * static_cast<double>(random.y);
        x = radius * std::cos(phi);
        y = radius * std::sin(phi);
    } else {
        x = w.x_min + (w.x_max - w.x_min) * static_cast<double>(random.x);
        y = w.y_min + (w.y_max - w.y_min) * static_cast<double>(random.y);
        if (ellipse_ && x * x + y * y > 1.0) return std::nullopt;
    }
    const Vec3d to = center_ + x_ * x + y_ * y;
    const Vec3d offset = to - position;
    const double distance = offset.length();
    if (!(distance > 0)) return std::nullopt;
    LampSample sample;
    sample.direction = offset / distance;
    sample.distance = distance;
    sample.density = density(position, to);
    sample.radiance = radiance_ * attenuation(-sample.direction.dot(normal_));
    return sample;
}

std::optional<LampSample> AreaLamp::sample(const Vec3d& position, const Vec2f& random) const {
    const Vec3d from_center = position - center_;
    const double height = from_center.dot(normal_);
    if (!(height > 0)) return std::nullopt;
    if (area_ == 0) {
        const double distance = from_center.length();
        const double cosine = height / distance;
        const Color irradiance(Vec3d(intensity_) * (cosine / (distance * distance)));
        return LampSample{-from_center / distance, distance, irradiance * attenuation(cosine), 1.0, true};
    }
    const std::optional<Window> w = window(position);
    if (!w) return std::nullopt;
    if (ellipse_ || !orthogonal_) return sample_by_area(position, random, *w);
    const SphericalRectangle rectangle = spherical(*w, x_, y_, from_center, height);
    if (!(rectangle.solid_angle() > kSmallestSphericalRectangle)) return sample_by_area(position, random, *w);
    const Vec2d at = rectangle.sample(random);
    const Vec3d offset = x_ * (at.x / x_.length()) + y_ * (at.y / y_.length()) - normal_ * height;
    const double distance = offset.length();
    LampSample sample;
    sample.direction = offset / distance;
    sample.distance = distance;
    sample.density = 1.0 / rectangle.solid_angle();
    sample.radiance = radiance_ * attenuation(height / distance);
    return sample;
}

std::optional<LampIntersection> AreaLamp::hit(const Ray& ray, const Vec3d& from) const {
    if (area_ == 0) return std::nullopt;
    const double cosine = -ray.direction.dot(normal_);
    if (!(cosine > 0)) return std::nullopt;
    const double t = (ray.origin - center_).dot(normal_) / cosine;
    if (!(t > ray.t_min && t < ray.t_max)) return std::nullopt;
    const Vec3d at = ray.origin + ray.direction * t;
    const Vec3d offset = at - center_;
    // Coordinates in units of the half edges, by Cramer's rule in the lamp's plane.
    const Vec3d cross = x_.cross(y_);
    const double x = offset.cross(y_).dot(cross) / cross.length2(), y = x_.cross(offset).dot(cross) / cross.length2();
    if (ellipse_ ? x * x + y * y > 1.0 : std::abs(x) > 1.0 || std::abs(y) > 1.0) return std::nullopt;
    const float dimming = attenuation(cosine);
    if (dimming == 0.0f) return std::nullopt;
    return LampIntersection{t, radiance_ * dimming, density(from, at)};
}

Box3d AreaLamp::bounds() const {
    Box3d box;
    for (const double sx : {-1.0, 1.0})
        for (const double sy : {-1.0, 1.0}) box.extendBy(center_ + x_ * sx + y_ * sy);
    return box;
}

}  // namespace rayleaf
