#include "lights/spherical_rectangle.h"

#include "base/circle.h"

namespace rayleaf {
namespace {

/// By how much the angle at a corner, seen from the viewpoint, exceeds a right one, as a complex number that is the
/// product of (x² + z²) and (y² + z²), rooted, long. `x` and `y` count outwards.
Vec2d excess(double x, double y, double height, double height_squared) {
    return {height * std::sqrt(x * x + y * y + height_squared), x * y};
}

/// Adds up angles.
Vec2d product(const Vec2d& a, const Vec2d& b) {
    return {a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x};
}

}  // namespace

SphericalRectangle::SphericalRectangle(double x0, double x1, double y0, double y1, double height)
    : x0_(x0), x1_(x1), y0_(y0), y1_(y1), height_(height), height_squared_(height * height) {
    const auto at = [&](double x, double y) { return excess(x, y, height, height_squared_); };
    excess_at_x0_ = product(at(-x0, y1), at(-x0, -y0));
    const Vec2d sum = product(product(at(x1, -y0), at(x1, y1)), excess_at_x0_);
    solid_angle_ = std::atan2(sum.y, sum.x);
    // More than half of what is above the viewpoint is seen from below the rectangle alone.
    if (solid_angle_ < 0.0 && x0 <= 0.0 && x1 >= 0.0 && y0 <= 0.0 && y1 >= 0.0) solid_angle_ += 2.0 * std::numbers::pi;
}

Vec2d SphericalRectangle::sample(const Vec2f& random) const {
    const Vec2d part = on_circle(static_cast<double>(random.x) * solid_angle_ * (0.5 / std::numbers::pi));
    // The paper's angle from half a turn on, backwards.
    const Vec2d angle = product(excess_at_x0_, {part.x, -part.y});
    // What the paper divides, and by what, to get f. Both are longer by the same.
    const double x0_squared = x0_ * x0_ + height_squared_, y0_squared = y0_ * y0_ + height_squared_;
    const double above = angle.x * y0_ - x0_squared * y0_squared * y1_, below = angle.y;
    const double remaining_f = std::max(1e-300, above * above - below * below * height_squared_);
    double x = std::copysign(height_, above) * below * std::sqrt(y0_squared / remaining_f);
    x = std::clamp(x, x0_, x1_);
    // What the paper calls h is this times the distances to both ends of the line at x.
    const double d_squared = x * x + height_squared_;
    const double to_0 = d_squared + y0_ * y0_, to_1 = d_squared + y1_ * y1_, v = static_cast<double>(random.y);
    const double h = y0_ * std::sqrt(to_1) * (1.0 - v) + y1_ * std::sqrt(to_0) * v;
    const double y = h * std::sqrt(d_squared / std::max(1e-300, to_0 * to_1 - h * h));
    return {x, std::clamp(y, y0_, y1_)};
}

}  // namespace rayleaf
