// A flat triangle that a ray was found to hit, or may hit: whether and where exactly, in double precision.
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
};

/// The ends of the borders v = 0, u = 1, v = 1, u = 0 of a quad, by its corners (0,0), (1,0), (0,1), (1,1); u or v
/// grows from the first to the second.
inline constexpr std::array<std::array<int, 2>, 4> kBorderEnds = {{{0, 1}, {1, 3}, {2, 3}, {0, 2}}};

/// Twice the facet's area along its normal by the winding.
inline Vec3d area_vector(const FacetCorners& corners) {
    return (corners[1] - corners[0]).cross(corners[2] - corners[0]);
}

/// How far the point of a ray that a test in single precision puts inside a facet may lie beside it, along the ray,
/// local units: sixteen times what rounding moves a ray aside, for rays down to a sixteenth of a radian to the facet.
inline constexpr double kBorderReach = 0x1p-17;

/// The hit of a ray that a test in single precision has found inside the facet. That test decides about inside, since
/// it agrees with the neighbours' along shared edges; here the point is only made exact, so weights that leave the
/// facet are drawn back to its border. Empty where the ray lies in the facet's plane, or the facet has no area. `speed`
/// is the length of `direction`, whose square may be zero or infinite.
inline std::optional<FacetHit> exact_facet_hit(const FacetCorners& corners, const Vec3d& origin, const Vec3d& direction,
                                               double speed) {
    // Cramer's rule on  origin + t direction = p0 + u edge1 + v edge2  (Moeller and Trumbore 1997).
    const Vec3d edge1 = corners[1] - corners[0], edge2 = corners[2] - corners[0];
    const Vec3d across = direction.cross(edge2);
    const double determinant = edge1.dot(across);
    // Rounding can give a facet without area a determinant: it would be hit, and have no normal.
    if (determinant == 0.0 || max_abs(edge1.cross(edge2)) == 0.0) return std::nullopt;
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
    hit.t = t_raw;
    if (hit.u == u_raw && hit.v == v_raw) return hit;
    // Beside the point that was drawn back. But where the ray starts on this facet's border or on its neighbour, only
    // the plane tells that it lies behind: the point has moved along the border by more than that.
    const double beside = (hit.position - origin).dot(direction / speed) / speed;
    hit.t = std::clamp(t_raw, beside - kBorderReach / speed, beside + kBorderReach / speed);
    return hit;
}

/// A ray that facets are tested against in double precision, by the steps of tessellation/grid_intersection.h: what it
/// computes for the edge between two facets is the same for both, so no ray passes between them.
class FacetRay {
  public:
    /// `begin` is the t near which facets lie, so that the distance of the origin costs no precision.
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

    /// Empty where the ray passes the facet or lies in its plane, or the facet has no area.
    std::optional<FacetHit> meet(const FacetCorners& corners) const {
        const Vec3d a = sheared(corners[0]), b = sheared(corners[1]), c = sheared(corners[2]);
        const double ab = edge(a, b), bc = edge(b, c), ca = edge(c, a);
        if ((ab < 0.0 || bc < 0.0 || ca < 0.0) && (ab > 0.0 || bc > 0.0 || ca > 0.0)) return std::nullopt;
        const double area = (bc + ca) + ab;
        const Vec3d edge1 = corners[1] - corners[0], edge2 = corners[2] - corners[0];
        if (area == 0.0 || max_abs(edge1.cross(edge2)) == 0.0) return std::nullopt;
        FacetHit hit;
        hit.u = std::min(ca / area, 1.0);
        hit.v = std::min(ab / area, 1.0 - hit.u);
        hit.position = corners[0] + edge1 * hit.u + edge2 * hit.v;
        hit.t = begin_ + ((bc * a.z + ca * b.z) + ab * c.z) / area * scale_z_;
        if (!std::isfinite(hit.t)) return std::nullopt;
        return hit;
    }

  private:
    Vec3d origin_;
    double begin_, shear_x_, shear_y_, scale_z_;
    int x_, y_, z_;

    /// To the origin, and so that the ray is the z axis; z is still to be scaled.
    Vec3d sheared(const Vec3d& corner) const {
        const Vec3d from = corner - origin_;
        return {from[x_] - shear_x_ * from[z_], from[y_] - shear_y_ * from[z_], from[z_]};
    }
    static double edge(const Vec3d& p, const Vec3d& q) { return p.x * q.y - p.y * q.x; }
};

}  // namespace rayleaf
