#include "shading/bump.h"

namespace rayleaf {

Vec3f bump_normal(const Vec3f& normal, const RayDifferential& footprint, const Heights& heights, float strength) {
    // Steps are measured by the larger: their products would be too small for floats.
    const float step = std::max(max_abs(footprint.dp_dx), max_abs(footprint.dp_dy));
    if (!(step > 0.0f) || !std::isfinite(step)) return normal;
    const Vec3f dp_dx = footprint.dp_dx / step, dp_dy = footprint.dp_dy / step;
    const Vec3f across_x = dp_dy.cross(normal), across_y = normal.cross(dp_dx);
    const float area = dp_dx.dot(across_x);
    const Vec3f gradient =
        (across_x * (heights.right - heights.here) + across_y * (heights.above - heights.here)) / step;
    const Vec3f bent = normalized_or(normal * std::abs(area) - gradient * std::copysign(1.0f, area), normal);
    const float share = std::max(strength, 0.0f);
    return normalized_or(bent * share + normal * (1.0f - share), normal);
}

}  // namespace rayleaf
