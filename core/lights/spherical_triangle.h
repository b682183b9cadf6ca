// A triangle seen from a point, sampled uniformly in solid angle.
//
// J. Arvo: Stratified Sampling of Spherical Triangles, SIGGRAPH 1995. The angle at the first corner is kept as a
// complex number, and the solid angle is that of A. van Oosterom, J. Strackee: The Solid Angle of a Plane Triangle,
// 1983, so that one angle is all that is asked of the library.
#pragma once

#include "base/vector.h"

#include <array>

namespace rayleaf {

class SphericalTriangle {
  public:
    /// The way from the viewpoint to each corner.
    explicit SphericalTriangle(const std::array<Vec3d, 3>& corners);

    /// 0 where the triangle is seen edge on, or lies around the viewpoint in one plane with it.
    double solid_angle() const { return solid_angle_; }
    /// A direction towards the triangle, unit. Its solid angle must not be 0.
    Vec3d sample(const Vec2f& random) const;

  private:
    Vec3d a_, b_;  ///< directions of two corners, unit
    Vec3d to_c_;   ///< unit, at right angles to a_: where the side to the third corner begins
    double a_dot_b_ = 0;
    Vec2d angle_{1, 0};  ///< cosine and sine of the angle at a_
    double solid_angle_ = 0;
};

}  // namespace rayleaf
