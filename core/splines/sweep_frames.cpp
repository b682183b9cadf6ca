#include "splines/sweep_frames.h"

namespace rayleaf {

Vec3d upright_normal(const Vec3d& tangent) {
    // Blender's choice for vertical tangents, for which up is undefined.
    constexpr double kVertical = 1e-12;
    if (std::abs(tangent.x) + std::abs(tangent.y) < kVertical) return {-1, 0, 0};
    return normalized_or(Vec3d(-tangent.y, tangent.x, 0), Vec3d(-1, 0, 0));
}

Vec3d carried(const Vec3d& from, const Vec3d& to, const Vec3d& across) {
    const double sum = 1.0 + from.dot(to);
    if (!(sum > kOpposite)) return across;
    return across - (from + to) * (to.dot(across) / sum);
}

CarriedNormal carried(const Vec3d& from, const Vec3d& to, const Vec3d& to_change, const Vec3d& across) {
    const double sum = 1.0 + from.dot(to);
    if (!(sum > kOpposite)) return {across, Vec3d(0.0)};
    const double share = to.dot(across) / sum;
    const double share_change = (to_change.dot(across) - share * from.dot(to_change)) / sum;
    return {across - (from + to) * share, -to_change * share - (from + to) * share_change};
}

Vec3d perpendicular(const Vec3d& across, const Vec3d& tangent) {
    const Vec3d part = across - tangent * tangent.dot(across);
    if (max_abs(part) > kNoPart) return normalized_or(part, across);
    return upright_normal(tangent);
}

Vec3d doubly_reflected(const CurveStation& from, const CurveStation& to, const Vec3d& across) {
    const Vec3d way = to.position - from.position;
    const double way2 = way.dot(way);
    if (!(way2 > 0.0)) return perpendicular(carried(from.tangent, to.tangent, across), to.tangent);
    const Vec3d first = across - way * (2.0 / way2 * way.dot(across));
    const Vec3d tangent = from.tangent - way * (2.0 / way2 * way.dot(from.tangent));
    const Vec3d other = to.tangent - tangent;
    const double other2 = other.dot(other);
    if (!(other2 > 0.0)) return perpendicular(first, to.tangent);
    return perpendicular(first - other * (2.0 / other2 * other.dot(first)), to.tangent);
}

double angle_about(const Vec3d& tangent, const Vec3d& from, const Vec3d& to) {
    return std::atan2(tangent.dot(from.cross(to)), from.dot(to));
}

CosineAndSine cosine_and_sine(double angle) {
    return {std::cos(angle), std::sin(angle)};
}

Vec3d turned(const Vec3d& tangent, const Vec3d& across, double angle) {
    return across * std::cos(angle) + tangent.cross(across) * std::sin(angle);
}

}  // namespace rayleaf
