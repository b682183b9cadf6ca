// The exact test, in double precision, of a flat triangle that a ray hits, or may hit, in single precision.
#pragma once

#include "base/vector.h"

#include <algorithm>
#include <array>
#include <optional>

namespace rayleaf {

using FacetCorners = std::array<Vec3d, 3>;

struct FacetHit {
    double t = 0;             ///< along `direction`, in its lengths
    double u = 0, v = 0;      ///< weights of corners 1 and 2; both, and 1 - u - v, are not negative
    Vec3d position{0, 0, 0};  ///< on the facet to double precision
    Vec3d normal{0, 0, 0};    ///< area_vector of the facet; a unit vector where something is hit that has no facets
};

/// The ends of the borders v = 0, u = 1, v = 1, u = 0 of a quad, by its corners (0,0), (1,0), (0,1), (1,1); u or v
/// grows from the first to the second.
inline constexpr std::array<std::array<int, 2>, 4> kBorderEnds = {{{0, 1}, {1, 3}, {2, 3}, {0, 2}}};

/// Twice the facet's area along its normal by the winding.
inline Vec3d area_vector(const FacetCorners& corners) {
    return (corners[1] - corners[0]).cross(corners[2] - corners[0]);
}

/// Parameters in the unit square, the upper half turned onto the lower: weights of corners 1 and 2.
inline Vec2f folded(const Vec2f& parameters) {
    return parameters.x + parameters.y > 1.0f ? Vec2f(1.0f) - parameters : parameters;
}

/// Corners that are so far from some to others.
inline FacetCorners mixed(const FacetCorners& from, const FacetCorners& to, double share) {
    return {from[0] + (to[0] - from[0]) * share, from[1] + (to[1] - from[1]) * share,
            from[2] + (to[2] - from[2]) * share};
}

/// If single precision finds a point inside a facet, it may be outside by this much along the ray, local units: sixteen
/// times the sideways error of a ray, for rays down to a sixteenth of a radian to the facet.
inline constexpr double kBorderReach = 0x1p-17;

/// The exact hit of a ray that single precision has found inside the facet. That test decides about inside, since it
/// agrees with that of neighbours along shared edges; here the point is only made exact, so weights outside the facet
/// are clamped to its border. Empty if the ray lies in the facet's plane, or the facet has no area. `speed` is the
/// length of `direction`, whose square may be zero or infinite.
inline std::optional<FacetHit> exact_facet_hit(const FacetCorners& corners, const Vec3d& origin, const Vec3d& direction,
                                               double speed) {
    // Cramer's rule on  origin + t direction = p0 + u edge1 + v edge2  (Moeller and Trumbore 1997).
    const Vec3d edge1 = corners[1] - corners[0], edge2 = corners[2] - corners[0];
    const Vec3d across = direction.cross(edge2);
    const double determinant = edge1.dot(across);
    const Vec3d normal = edge1.cross(edge2);
    // By rounding, a facet without area can have a determinant: it would be hit, without a normal.
    if (determinant == 0.0 || max_abs(normal) == 0.0) return std::nullopt;
    const Vec3d from = origin - corners[0];
    const Vec3d other = from.cross(edge1);
    const double scale = 1.0 / determinant;
    const double u_raw = from.dot(across) * scale, v_raw = direction.dot(other) * scale;
    const double t_raw = edge2.dot(other) * scale;
    if (!std::isfinite(u_raw + v_raw + t_raw)) return std::nullopt;
    FacetHit hit;
    hit.u = std::clamp(u_raw, 0.0, 1.0);
    hit.v = std::clamp(v_raw, 0.0, 1.0 - hit.u);
    hit.position = corners[0] + edge1 * hit.u + edge2 * hit.v;
    hit.normal = normal;
    hit.t = t_raw;
    if (hit.u == u_raw && hit.v == v_raw) return hit;
    // The distance to the clamped point. But if the ray starts on this facet's border or on its neighbour, only the
    // plane shows that the facet is behind: the point has moved along the border by more than that.
    const double beside = (hit.position - origin).dot(direction / speed) / speed;
    hit.t = std::clamp(t_raw, beside - kBorderReach / speed, beside + kBorderReach / speed);
    return hit;
}

/// Tests a ray against facets in double precision, by the steps of tessellation/grid_intersection.h: the result for an
/// edge is the same for both of its facets, so no ray passes between them.
class FacetRay {
  public:
    /// `begin` is a t near the facets, so that a distant origin loses no precision.
    FacetRay(const Vec3d& origin, const Vec3d& direction, double begin)
        : origin_(origin + direction * begin), begin_(begin) {
        const Vec3d size(std::abs(direction.x), std::abs(direction.y), std::abs(direction.z));
        z_ = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
        x_ = (z_ + 1) % 3;
        y_ = (z_ + 2) % 3;
        scale_z_ = 1.0 / direction[z_];
        shear_x_ = direction[x_] / direction[z_];
        shear_y_ = direction[y_] / direction[z_];
    }

    /// Empty if the ray misses the facet or lies in its plane, or the facet has no area.
    std::optional<FacetHit> meet(const FacetCorners& corners) const {
        const Vec3d a = sheared(corners[0]), b = sheared(corners[1]), c = sheared(corners[2]);
        const double ab = edge(a, b), bc = edge(b, c), ca = edge(c, a);
        if ((ab < 0.0 || bc < 0.0 || ca < 0.0) && (ab > 0.0 || bc > 0.0 || ca > 0.0)) return std::nullopt;
        const double area = (bc + ca) + ab;
        const Vec3d edge1 = corners[1] - corners[0], edge2 = corners[2] - corners[0];
        const Vec3d normal = edge1.cross(edge2);
        if (area == 0.0 || max_abs(normal) == 0.0) return std::nullopt;
        FacetHit hit;
        hit.u = std::min(ca / area, 1.0);
        hit.v = std::min(ab / area, 1.0 - hit.u);
        hit.position = corners[0] + edge1 * hit.u + edge2 * hit.v;
        hit.normal = normal;
        hit.t = begin_ + ((bc * a.z + ca * b.z) + ab * c.z) / area * scale_z_;
        if (!std::isfinite(hit.t)) return std::nullopt;
        return hit;
    }

  private:
    Vec3d origin_;
    double begin_, shear_x_, shear_y_, scale_z_;
    int x_, y_, z_;

    /// A corner in the space in which the ray is the z axis; z is not scaled yet.
    Vec3d sheared(const Vec3d& corner) const {
        const Vec3d from = corner - origin_;
        return {from[x_] - shear_x_ * from[z_], from[y_] - shear_y_ * from[z_], from[z_]};
    }
    static double edge(const Vec3d& p, const Vec3d& q) { return p.x * q.y - p.y * q.x; }
};

}  // namespace rayleaf
