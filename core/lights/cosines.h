// Cosines by which a light is chosen: of the angle at the light, or at the point that it shines on, at best. In single
// precision: they are weights of a choice, and whoever asks for a density computes the same ones again.
#pragma once

#include "base/vector.h"

#include <algorithm>
#include <cmath>

namespace rayleaf {

/// Cosines that are less count as this, so that no light that may arrive is never chosen: normals of curved surfaces
/// and of bumps are estimates.
constexpr float kLeastCosine = 0.05f;

/// The half angle of a cone, 0 to pi.
struct HalfAngle {
    float cosine = 1, sine = 0;

    static HalfAngle of_cosine(float cosine) { return {cosine, std::sqrt(std::max(0.0f, 1.0f - cosine * cosine))}; }
};

/// The cosine of an angle that is made smaller by another, down to none.
inline float narrowed(float cosine, const HalfAngle& by) {
    if (cosine >= by.cosine) return 1.0f;
    return cosine * by.cosine + std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)) * by.sine;
}

/// At a point with unit `normal`, of light from a cone of half angle `seen` about unit `direction`; 1 where the normal
/// is zero, which stands for all directions.
inline float cosine_at_surface(const Vec3f& normal, const Vec3f& direction, const HalfAngle& seen) {
    if (normal == Vec3f(0.0f)) return 1.0f;
    return std::max(kLeastCosine, narrowed(direction.dot(normal), seen));
}

}  // namespace rayleaf
