#include "geometry/facet.h"

#include <algorithm>

namespace rayleaf {

std::optional<FacetHit> exact_facet_hit(const FacetCorners& corners, const Vec3d& origin, const Vec3d& direction) {
    // Cramer's rule on  origin + t direction = p0 + u edge1 + v edge2  (Moeller and Trumbore 1997).
    const Vec3d edge1 = corners[1] - corners[0], edge2 = corners[2] - corners[0];
    const Vec3d across = direction.cross(edge2);
    const double determinant = edge1.dot(across);
    if (determinant == 0.0) return std::nullopt;
    const Vec3d from = origin - corners[0];
    const Vec3d other = from.cross(edge1);
    const double u_raw = from.dot(across) / determinant, v_raw = direction.dot(other) / determinant;
    const double t_raw = edge2.dot(other) / determinant;
    if (!std::isfinite(u_raw + v_raw + t_raw)) return std::nullopt;
    FacetHit hit;
    hit.u = std::clamp(u_raw, 0.0, 1.0);
    hit.v = std::clamp(v_raw, 0.0, 1.0 - hit.u);
    hit.position = corners[0] + edge1 * hit.u + edge2 * hit.v;
    const bool moved = hit.u != u_raw || hit.v != v_raw;
    hit.t = moved ? (hit.position - origin).dot(direction) / direction.dot(direction) : t_raw;
    return hit;
}

}  // namespace rayleaf
