// Reflection and refraction of directions, for vectors of either precision.
#pragma once

#include <cmath>
#include <optional>

namespace rayleaf {

template <typename Vector>
Vector reflected_direction(const Vector& direction, const Vector& normal) {
    return direction - normal * (2 * direction.dot(normal));
}

/// Snell's law; `normal` faces the incoming side, `eta` is the incoming side's index over the other's. Unit up to
/// rounding. Empty: total internal reflection.
template <typename Vector>
std::optional<Vector> refracted_by_snell(const Vector& direction, const Vector& normal, typename Vector::BaseType eta) {
    const auto cosine = -direction.dot(normal);
    const auto beyond = 1 - eta * eta * (1 - cosine * cosine);
    if (beyond < 0) return std::nullopt;
    return direction * eta + normal * (eta * cosine - std::sqrt(beyond));
}

}  // namespace rayleaf
