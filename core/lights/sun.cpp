#include "lights/sun.h"

namespace rayleaf {

Sun::Sun(const Lamp& lamp)
    : towards_(normalized_or(lamp.to_world.z, Vec3d(0, 0, 1))), axis_(towards_.axis), irradiance_(lamp.strength) {
    const double radius = 0.5 * std::clamp(lamp.angle, 0.0, std::numbers::pi);
    const double half_sine = std::sin(0.5 * radius);
    one_minus_cosine_ = 2.0 * half_sine * half_sine;
    sine_squared_ = std::sin(radius) * std::sin(radius);
    half_angle_ = {static_cast<float>(std::cos(radius)), static_cast<float>(std::sin(radius))};
    solid_angle_ = 2.0 * std::numbers::pi * one_minus_cosine_;
    if (solid_angle_ > kSmallestSolidAngle) radiance_ = Color(Vec3d(irradiance_) / solid_angle_);
    if (!(solid_angle_ > kSmallestSolidAngle) || !is_usable(radiance_)) solid_angle_ = 0;
    if (solid_angle_ > 0) density_ = 1.0 / solid_angle_;
}

Maybe<LightSample> Sun::sample(const Vec2f& random) const {
    Maybe<LightSample> result;
    LightSample& sample = result.emplace();
    sample.distance = std::numeric_limits<double>::infinity();
    sample.density = static_cast<float>(density_);
    if (solid_angle_ == 0) {
        sample.direction = axis_;
        sample.radiance = irradiance_;
        sample.delta = true;
    } else {
        sample.direction = Vec3f(sample_cone(towards_, one_minus_cosine_, random).direction);
        sample.radiance = radiance_;
    }
    return result;
}

bool Sun::is_met(const Ray& ray) const {
    constexpr double kRounding = 1e-6;
    const double cosine = ray.direction.dot(towards_.axis);
    if (solid_angle_ == 0 || cosine <= 0 || cosine < double{half_angle_.cosine} - kRounding) return false;
    return ray.direction.cross(towards_.axis).length2() <= sine_squared_;
}

std::optional<LampIntersection> Sun::hit(const Ray& ray) const {
    if (!is_met(ray)) return std::nullopt;
    return LampIntersection{std::numeric_limits<double>::infinity(), radiance_, density_};
}

}  // namespace rayleaf
