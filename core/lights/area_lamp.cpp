#include "lights/area_lamp.h"

#include "base/circle.h"

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
      x_length_(x_.length()),
      y_length_(y_.length()),
      intensity_(lamp.strength * 0.25f),
      ellipse_(lamp.kind == LampKind::Disk) {
    const Vec3d forward = normalized_or(-lamp.to_world.z, Vec3d(0, 0, -1));
    const Vec3d cross = x_.cross(y_);
    normal_ = normalized_or(cross, forward);
    if (normal_.dot(forward) < 0) normal_ = -normal_;
    // By Cramer's rule in the lamp's plane.
    along_x_ = y_.cross(cross) / cross.length2();
    along_y_ = cross.cross(x_) / cross.length2();
    unit_area_ = cross.length();
    area_ = unit_area_ * (ellipse_ ? std::numbers::pi : 4.0);
    orthogonal_ = std::abs(x_.dot(y_)) <= kRightAngle * x_length_ * y_length_;
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

std::optional<AreaLamp::Place> AreaLamp::place(const Vec3d& position) const {
    const Vec3d offset = position - center_;
    const double height = offset.dot(normal_);
    if (!(height > 0)) return std::nullopt;
    return Place{position, offset, height};
}

std::optional<AreaLamp::Window> AreaLamp::window(const Place& at) const {
    Window window{-1, 1, -1, 1};
    if (cot_spread_ == 0 || !orthogonal_) return window;
    const double visible = at.height / cot_spread_;
    const auto clip = [&](double middle, double length, double& low, double& high) {
        const double half = visible / length;
        low = std::max(low, middle - half);
        high = std::min(high, middle + half);
        return low < high;
    };
    if (!clip(at.offset.dot(along_x_), x_length_, window.x_min, window.x_max) ||
        !clip(at.offset.dot(along_y_), y_length_, window.y_min, window.y_max))
        return std::nullopt;
    return window;
}

bool AreaLamp::samples_whole_ellipse(const Window& w) const {
    return ellipse_ && (w.x_max - w.x_min) * (w.y_max - w.y_min) >= std::numbers::pi;
}

/// The window as a spherical rectangle; the half edges are at right angles.
SphericalRectangle AreaLamp::spherical(const Place& at, const Window& w) const {
    const double x_at = at.offset.dot(along_x_), y_at = at.offset.dot(along_y_);
    return {(w.x_min - x_at) * x_length_, (w.x_max - x_at) * x_length_, (w.y_min - y_at) * y_length_,
            (w.y_max - y_at) * y_length_, at.height};
}

double AreaLamp::density_by_area(const Place& at, const Window& w, double distance) const {
    const double sampled = samples_whole_ellipse(w) ? area_ : (w.x_max - w.x_min) * (w.y_max - w.y_min) * unit_area_;
    return std::min(kLargestDensity, distance * distance * distance / (at.height * sampled));
}

double AreaLamp::density(const Vec3d& position, const Vec3d& to) const {
    const std::optional<Place> at = place(position);
    if (!at) return 0;
    const std::optional<Window> w = window(*at);
    if (!w) return 0;
    if (!ellipse_ && orthogonal_) {
        const double solid_angle = spherical(*at, *w).solid_angle();
        if (solid_angle > kSmallestSphericalRectangle) return 1.0 / solid_angle;
    }
    return density_by_area(*at, *w, (to - position).length());
}

double AreaLamp::set_towards(const Place& at, const Vec3d& way, Maybe<LightSample>& result) const {
    LightSample& sample = result.emplace();
    const double distance = way.length(), inverse = 1.0 / distance;
    sample.direction = Vec3f(way * inverse);
    sample.distance = distance;
    sample.target = at.position + way;
    sample.radiance = radiance_ * attenuation(at.height * inverse);
    return distance;
}

void AreaLamp::sample_point(const Place& at, Maybe<LightSample>& result) const {
    const double distance = set_towards(at, -at.offset, result), cosine = at.height / distance;
    result->radiance = Color(Vec3d(intensity_) * (cosine / (distance * distance))) * attenuation(cosine);
    result->density = 1.0f;
    result->delta = true;
}

void AreaLamp::sample_by_area(const Place& at, const Window& w, const Vec2f& random, Maybe<LightSample>& result) const {
    Vec2d place;
    if (samples_whole_ellipse(w)) {
        place = on_circle(static_cast<double>(random.y)) * std::sqrt(static_cast<double>(random.x));
    } else {
        place.x = w.x_min + (w.x_max - w.x_min) * static_cast<double>(random.x);
        place.y = w.y_min + (w.y_max - w.y_min) * static_cast<double>(random.y);
        if (ellipse_ && place.length2() > 1.0) return;
    }
    const double distance = set_towards(at, x_ * place.x + y_ * place.y - at.offset, result);
    result->density = static_cast<float>(density_by_area(at, w, distance));
}

void AreaLamp::sample_within(const Place& at, const Window& w, const Vec2f& random, Maybe<LightSample>& result) const {
    if (ellipse_ || !orthogonal_) return sample_by_area(at, w, random, result);
    const SphericalRectangle rectangle = spherical(at, w);
    if (!(rectangle.solid_angle() > kSmallestSphericalRectangle)) return sample_by_area(at, w, random, result);
    const Vec2d to = rectangle.sample(random);
    set_towards(at, x_ * (to.x / x_length_) + y_ * (to.y / y_length_) - normal_ * at.height, result);
    result->density = static_cast<float>(1.0 / rectangle.solid_angle());
}

Maybe<LightSample> AreaLamp::sample(const Vec3d& position, const Vec2f& random) const {
    Maybe<LightSample> result;
    const std::optional<Place> at = place(position);
    if (!at) return result;
    if (area_ == 0) {
        sample_point(*at, result);
        return result;
    }
    if (const std::optional<Window> w = window(*at)) sample_within(*at, *w, random, result);
    return result;
}

std::optional<LampIntersection> AreaLamp::hit(const Ray& ray, double end, const Vec3d& from) const {
    if (area_ == 0 || !may_be_met(ray, end)) return std::nullopt;
    const double cosine = -ray.direction.dot(normal_), t = (ray.origin - center_).dot(normal_) / cosine;
    const float dimming = attenuation(cosine);
    if (dimming == 0.0f) return std::nullopt;
    return LampIntersection{t, radiance_ * dimming, density(from, ray.at(t))};
}

Box3d AreaLamp::bounds() const {
    Box3d box;
    for (const double sx : {-1.0, 1.0})
        for (const double sy : {-1.0, 1.0}) box.extendBy(center_ + x_ * sx + y_ * sy);
    return box;
}

}  // namespace rayleaf
