#include "lights/lamp_sample.h"

#include "base/circle.h"

namespace rayleaf {

ConeFrame::ConeFrame(const Vec3d& n) : axis(n) {
    const double sign = std::copysign(1.0, n.z);
    const double a = -1.0 / (sign + n.z);
    const double b = n.x * n.y * a;
    tangent = Vec3d(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
    bitangent = Vec3d(b, sign + n.y * n.y * a, -n.y);
}

ConeDirection sample_cone(const ConeFrame& frame, double one_minus_cosine, const Vec2f& random) {
    const double below = one_minus_cosine * static_cast<double>(random.x);
    const double sine = std::sqrt(std::max(0.0, below * (2.0 - below)));
    const Vec2d around = on_circle(static_cast<double>(random.y)) * sine;
    return {frame.axis * (1.0 - below) + frame.tangent * around.x + frame.bitangent * around.y, below};
}

}  // namespace rayleaf
