#include "lights/spherical_rectangle.h"

namespace rayleaf {
namespace {

double angle_between(const Vec3d& a, const Vec3d& b) {
    return std::acos(std::clamp(-a.dot(b), -1.0, 1.0));
}

}  // namespace

SphericalRectangle::SphericalRectangle(double x0, double x1, double y0, double y1, double height)
    : x0_(x0), x1_(x1), y0_(y0), y1_(y1), z0_(-height) {
    const Vec3d v00(x0_, y0_, z0_), v01(x0_, y1_, z0_), v10(x1_, y0_, z0_), v11(x1_, y1_, z0_);
    const Vec3d up(0, 0, 1);
    const Vec3d n0 = normalized_or(v00.cross(v10), up), n1 = normalized_or(v10.cross(v11), up);
    const Vec3d n2 = normalized_or(v11.cross(v01), up), n3 = normalized_or(v01.cross(v00), up);
    b0_ = n0.z;
    b1_ = n2.z;
    k_ = 2.0 * std::numbers::pi - angle_between(n2, n3) - angle_between(n3, n0);
    solid_angle_ = angle_between(n0, n1) + angle_between(n1, n2) - k_;
}

Vec2d SphericalRectangle::sample(const Vec2f& random) const {
    const double angle = static_cast<double>(random.x) * solid_angle_ + k_;
    const double f = (std::cos(angle) * b0_ - b1_) / std::sin(angle);
    const double c = std::clamp(std::copysign(1.0, f) / std::sqrt(f * f + b0_ * b0_), -1.0, 1.0);
    double x = -(c * z0_) / std::sqrt(std::max(1.0 - c * c, 1e-300));
    x = std::clamp(x, x0_, x1_);
    const double d_squared = x * x + z0_ * z0_;
    const double h0 = y0_ / std::sqrt(d_squared + y0_ * y0_), h1 = y1_ / std::sqrt(d_squared + y1_ * y1_);
    const double h = h0 + static_cast<double>(random.y) * (h1 - h0);
    const double remaining = 1.0 - h * h;
    const double y = remaining > 1e-12 ? h * std::sqrt(d_squared / remaining) : std::copysign(y1_ - y0_, h);
    return {x, std::clamp(y, y0_, y1_)};
}

}  // namespace rayleaf
