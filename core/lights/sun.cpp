#include "lights/sun.h"

namespace rayleaf {

Sun::Sun(const Lamp& lamp) : towards_(normalized_or(lamp.to_world.z, Vec3d(0, 0, 1))), irradiance_(lamp.strength) {
    const double radius = 0.5 * std::clamp(lamp.angle, 0.0, std::numbers::pi);
    const double half_sine = std::sin(0.5 * radius);
    one_minus_cosine_ = 2.0 * half_sine * half_sine;
    sine_squared_ = std::sin(radius) * std::sin(radius);
    half_angle_ = {static_cast<float>(std::cos(radius)), static_cast<float>(std::sin(radius))};
    solid_angle_ = 2.0 * std::numbers::pi * one_minus_cosine_;
    if (solid_angle_ > kSmallestSolidAngle) radiance_ = Color(Vec3d(irradiance_) / solid_angle_);
    if (!(solid_angle_ > kSmallestSolidAngle) || !is_usable(radiance_)) solid_angle_ = 0;
}

LampSample Sun::sample(const Vec2f& random) const {
    const double far = std::numeric_limits<double>::infinity();
    if (solid_angle_ == 0) return {towards_, far, {0, 0, 0}, irradiance_, 1.0, true};
    const Vec3d direction = sample_cone(towards_, one_minus_cosine_, random).direction;
    return {direction, far, {0, 0, 0}, radiance_, 1.0 / solid_angle_, false};
}

std::optional<LampIntersection> Sun::hit(const Ray& ray) const {
    if (solid_angle_ == 0) return std::nullopt;
    if (ray.direction.dot(towards_) <= 0 || ray.direction.cross(towards_).length2() > sine_squared_)
        return std::nullopt;
    return LampIntersection{std::numeric_limits<double>::infinity(), radiance_, 1.0 / solid_angle_};
}

}  // namespace rayleaf
