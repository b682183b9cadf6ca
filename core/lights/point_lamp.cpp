#include "lights/point_lamp.h"

namespace rayleaf {
namespace {

constexpr double kSphere = 4.0 * std::numbers::pi;  ///< solid angle of all directions

}  // namespace

PointLamp::PointLamp(const Lamp& lamp)
    : center_(lamp.to_world.translation),
      radius_(std::max(0.0, lamp.radius)),
      soft_(lamp.soft_falloff),
      intensity_(lamp.strength * static_cast<float>(1.0 / kSphere)),
      axis_(normalized_or(-lamp.to_world.z, Vec3d(0, 0, -1))),
      spot_(lamp.kind == LampKind::Spot),
      profile_(lamp.spot_profile) {
    radiance_ = Color(Vec3d(intensity_) / (std::numbers::pi * radius_ * radius_));
    if (!(radius_ > 0) || !is_usable(radiance_)) radius_ = 0;
    if (!spot_) return;
    cos_half_ = std::cos(0.5 * std::clamp(lamp.spot_size, 0.0, std::numbers::pi));
    fade_width_ = (1.0 - cos_half_) * std::clamp(lamp.spot_blend, 0.0, 1.0);
    lit_ = LitCone::of_sphere(center_, radius_, axis_, cos_half_);
}

/// As in Cycles: the profile, faded by a smooth step towards the cone's border.
float PointLamp::attenuation(const Vec3d& towards_lamp) const {
    if (!spot_) return 1.0f;
    const double cosine = -towards_lamp.dot(axis_);
    const double inside = cosine - cos_half_;
    if (!(inside > 0)) return 0.0f;
    const double profile = profile_ == SpotProfile::Cosine ? cosine : 1.0;
    if (!(inside < fade_width_)) return static_cast<float>(profile);
    const double x = inside / fade_width_;
    return static_cast<float>(profile * x * x * (3.0 - 2.0 * x));
}

double PointLamp::sine_squared(double distance_squared) const {
    const double square = radius_ * radius_;
    return square / (soft_ ? distance_squared + square : distance_squared);
}

double PointLamp::density(const Vec3d& position) const {
    const double sine = sine_squared((center_ - position).length2());
    if (!(sine < 1.0)) return soft_ ? 0.0 : 1.0 / kSphere;
    return std::min(kLargestDensity, 1.0 / cone_solid_angle(sine));
}

void PointLamp::sample_inside(const Vec3d& position, const Vec2f& random, LightSample& sample) const {
    const Vec3d offset = center_ - position;
    const Vec3d direction = sample_cone(ConeFrame(Vec3d(0, 0, 1)), 2.0, random).direction;
    const double along = offset.dot(direction);
    sample.direction = Vec3f(direction);
    sample.distance = along + std::sqrt(std::max(0.0, along * along - offset.length2() + radius_ * radius_));
    sample.target = position + direction * sample.distance;
    sample.density = static_cast<float>(1.0 / kSphere);
    sample.radiance = radiance_ * attenuation(direction);
}

void PointLamp::sample_outside(const Vec3d& position, const Vec2f& random, LightSample& sample) const {
    const Vec3d offset = center_ - position;
    const double distance = offset.length();
    const Vec3d axis = offset / distance;
    const double solid_angle = cone_solid_angle(sine_squared(distance * distance));
    if (radius_ == 0 || solid_angle < kSmallestSolidAngle) {
        sample.direction = Vec3f(axis);
        sample.distance = distance;
        sample.target = center_;
        sample.radiance = Color(Vec3d(intensity_) / (distance * distance)) * attenuation(axis);
        sample.density = 1.0f;
        sample.delta = true;
        return;
    }
    const double one_minus_cosine = solid_angle * (0.5 / std::numbers::pi);
    const ConeDirection cone = sample_cone(ConeFrame(axis), one_minus_cosine, random);
    const double below = cone.one_minus_cosine;
    const double half_chord_squared = radius_ * radius_ - distance * distance * below * (2.0 - below);
    sample.direction = Vec3f(cone.direction);
    sample.distance =
        soft_ ? distance / (1.0 - below) : distance * (1.0 - below) - std::sqrt(std::max(0.0, half_chord_squared));
    sample.target = position + cone.direction * sample.distance;
    sample.density = static_cast<float>(1.0 / solid_angle);
    sample.radiance = radiance_ * attenuation(cone.direction);
}

Maybe<LightSample> PointLamp::sample(const Vec3d& position, const Vec2f& random) const {
    Maybe<LightSample> result;
    const double distance_squared = (center_ - position).length2();
    if (radius_ > 0 && !soft_ && !(sine_squared(distance_squared) < 1.0))
        sample_inside(position, random, result.emplace());
    else if (distance_squared > 0 && std::isfinite(distance_squared))
        sample_outside(position, random, result.emplace());
    return result;
}

std::optional<double> PointLamp::distance_to_sphere(const Ray& ray, const Vec3d& from) const {
    const Vec3d offset = center_ - ray.origin;
    const double along = offset.dot(ray.direction);
    const double miss_squared = (offset - ray.direction * along).length2();
    const double half_chord_squared = radius_ * radius_ - miss_squared;
    if (half_chord_squared < 0) return std::nullopt;
    const bool inside = (center_ - from).length2() <= radius_ * radius_;
    const double half_chord = std::sqrt(half_chord_squared);
    return inside ? along + half_chord : along - half_chord;
}

std::optional<double> PointLamp::distance_to_disk(const Ray& ray, const Vec3d& from) const {
    const Vec3d facing = center_ - from, offset = center_ - ray.origin;
    const double approach = ray.direction.dot(facing);
    if (!(approach > 0)) return std::nullopt;
    const double t = offset.dot(facing) / approach;
    if (!((offset - ray.direction * t).length2() <= radius_ * radius_)) return std::nullopt;
    return t;
}

std::optional<LampIntersection> PointLamp::hit(const Ray& ray, double end, const Vec3d& from) const {
    if (radius_ == 0) return std::nullopt;
    const std::optional<double> t = soft_ ? distance_to_disk(ray, from) : distance_to_sphere(ray, from);
    if (!t || !(*t > ray.t_min && *t < end)) return std::nullopt;
    return LampIntersection{*t, radiance_ * attenuation(ray.direction), density(from)};
}

Box3d PointLamp::bounds() const {
    const Vec3d half(radius_, radius_, radius_);
    return {center_ - half, center_ + half};
}

}  // namespace rayleaf
