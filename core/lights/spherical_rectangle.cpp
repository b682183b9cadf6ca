#include "lights/spherical_rectangle.h"

namespace rayleaf {
namespace {

/// Between two planes through the viewpoint, one along each axis, inside the rectangle; of their normals only z counts.
double angle_between(double a, double b) {
    return std::acos(std::clamp(-a * b, -1.0, 1.0));
}

}  // namespace

SphericalRectangle::SphericalRectangle(double x0, double x1, double y0, double y1, double height)
    : x0_(x0), x1_(x1), y0_(y0), y1_(y1), z0_(-height) {
    // z of the unit normals of the planes through the edges.
    const auto normal = [&](double edge) { return edge / std::sqrt(edge * edge + z0_ * z0_); };
    const double n0 = normal(-y0_), n1 = normal(x1_), n2 = normal(y1_), n3 = normal(-x0_);
    b0_ = n0;
    b1_ = n2;
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
