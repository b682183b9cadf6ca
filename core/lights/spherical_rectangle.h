// A rectangle seen from a point, sampled uniformly in solid angle.
//
// C. Ureña, M. Fajardo, A. King: An Area-Preserving Parametrization for Spherical Rectangles, EGSR 2013, section 4;
// the angles at its corners are kept as complex numbers, so that one angle is all that is asked of the library.
#pragma once

#include "base/vector.h"

namespace rayleaf {

class SphericalRectangle {
  public:
    /// In a frame at the viewpoint whose axes follow the edges: the rectangle [x0, x1] x [y0, y1] at height -`height`
    /// (> 0).
    SphericalRectangle(double x0, double x1, double y0, double y1, double height);

    double solid_angle() const { return solid_angle_; }
    /// The point (x, y) in that frame.
    Vec2d sample(const Vec2f& random) const;

  private:
    double x0_, x1_, y0_, y1_, height_, height_squared_;
    Vec2d excess_at_x0_;  ///< of the angles at the two corners there
    double solid_angle_;
};

}  // namespace rayleaf
