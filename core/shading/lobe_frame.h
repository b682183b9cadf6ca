// A lobe's local frame and the sampling of a cosine-weighted hemisphere.
#pragma once

#include "base/circle.h"
#include "shading/closures.h"

namespace rayleaf {

/// World to local and back: z the lobe's normal, x its tangent.
struct LobeFrame {
    Vec3f x, y, z;

    explicit LobeFrame(const Lobe& lobe) : x(lobe.tangent), y(lobe.normal.cross(lobe.tangent)), z(lobe.normal) {}
    Vec3f to_local(const Vec3f& v) const { return {x.dot(v), y.dot(v), z.dot(v)}; }
    Vec3f to_world(const Vec3f& v) const { return x * v.x + y * v.y + z * v.z; }
};

/// Direction about +z with density cosine / pi.
inline Vec3f cosine_hemisphere(float u, float v) {
    const Vec2f at = on_circle(v) * std::sqrt(u);
    return {at.x, at.y, std::sqrt(std::max(0.0f, 1.0f - u))};
}

}  // namespace rayleaf
