#include "lights/spherical_triangle.h"

#include "base/circle.h"

namespace rayleaf {
namespace {

/// On the unit sphere, from `from` on: so far, by the cosine, as `along`, unit and at right angles to it, leads.
Vec3d at_cosine(const Vec3d& from, const Vec3d& along, double cosine) {
    return from * cosine + along * std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
}

/// The part of a vector at right angles to a unit one, unit.
Vec3d across(const Vec3d& vector, const Vec3d& unit) {
    return normalized_or(vector - unit * unit.dot(vector), Vec3d(0.0));
}

}  // namespace

SphericalTriangle::SphericalTriangle(const std::array<Vec3d, 3>& corners)
    : a_(normalized_or(corners[0], Vec3d(0.0))), b_(normalized_or(corners[1], Vec3d(0.0))) {
    const Vec3d c = normalized_or(corners[2], Vec3d(0.0)), to_b = a_.cross(b_), to_c = a_.cross(c);
    const double volume = std::abs(a_.dot(b_.cross(c))), lengths = to_b.length() * to_c.length();
    if (!(volume > 0.0) || !(lengths > 0.0)) return;
    a_dot_b_ = a_.dot(b_);
    to_c_ = across(c, a_);
    angle_ = Vec2d(to_b.dot(to_c), volume) / lengths;
    solid_angle_ = 2.0 * std::atan2(volume, 1.0 + a_dot_b_ + b_.dot(c) + c.dot(a_));
}

Vec3d SphericalTriangle::sample(const Vec2f& random) const {
    // Parted from corner b to the opposite side, so that what lies on a's side is a share of the whole. The paper's s
    // and t: sine and cosine of that share less the angle at a.
    const Vec2d share = on_circle(static_cast<double>(random.x) * solid_angle_ * (0.5 / std::numbers::pi));
    const double s = share.y * angle_.x - share.x * angle_.y, t = share.x * angle_.x + share.y * angle_.y;
    const double u = t - angle_.x, v = s + angle_.y * a_dot_b_;
    const double above = (v * t - u * s) * angle_.x - v, below = (v * s + u * t) * angle_.y;
    const double cosine = below != 0.0 ? std::clamp(above / below, -1.0, 1.0) : 1.0;
    const Vec3d c = at_cosine(a_, to_c_, cosine);
    const double z = 1.0 - static_cast<double>(random.y) * (1.0 - c.dot(b_));
    return at_cosine(b_, across(c, b_), z);
}

}  // namespace rayleaf
