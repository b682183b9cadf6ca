#include "lights/lit_cone.h"

#include <algorithm>
#include <cmath>

namespace rayleaf {

LitCone LitCone::of_sphere(const Vec3d& center, double radius, const Vec3d& axis, double cosine) {
    constexpr double kNarrow = 1e-3;  // sine of the half angle, below which the apex would be far away
    constexpr double kBeyond = 1e-9;  // keeps what lies on the border inside, whatever its rounding
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    if (sine < kNarrow || !(cosine >= 0.0)) return {};
    return {center - axis * (radius / sine), axis, std::max(0.0, cosine - kBeyond)};
}

bool LitCone::holds(const Vec3d& position) const {
    if (!is_bounded_) return true;
    const Vec3d offset = position - apex_;
    const double along = offset.dot(axis_);
    return along > 0.0 && along * along >= cosine_squared_ * offset.length2();
}

std::optional<LitPart> LitCone::part_of(const Ray& ray, double end) const {
    if (!is_bounded_) return LitPart{0.0, end};
    // a t² + 2 b t + c >= 0 in both halves of the double cone.
    const Vec3d offset = ray.origin - apex_;
    const double rise = ray.direction.dot(axis_), along = offset.dot(axis_);
    LitPart part{0.0, end};
    const auto cut = [&](double t, bool is_lit_beyond) {
        if (is_lit_beyond)
            part.begin = std::max(part.begin, t);
        else
            part.end = std::min(part.end, t);
    };
    if (cosine_squared_ == 0.0) {
        if (rise != 0.0)
            cut(-along / rise, rise > 0.0);
        else if (!(along > 0.0))
            return std::nullopt;
    } else {
        const double a = rise * rise - cosine_squared_ * ray.direction.length2();
        const double b = rise * along - cosine_squared_ * ray.direction.dot(offset);
        const double c = along * along - cosine_squared_ * offset.length2();
        const double root = std::sqrt(std::max(0.0, b * b - a * c));
        if (a == 0.0) return part;
        const double first = std::min((-b - root) / a, (-b + root) / a);
        const double second = std::max((-b - root) / a, (-b + root) / a);
        if (a > 0.0) {
            cut(rise > 0.0 ? second : first, rise > 0.0);
        } else {
            if (b * b < a * c || !(along + rise * 0.5 * (first + second) > 0.0)) return std::nullopt;
            cut(first, true);
            cut(second, false);
        }
    }
    if (!(part.begin < part.end)) return std::nullopt;
    return part;
}

}  // namespace rayleaf
