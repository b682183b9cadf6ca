// Strands as a ray sees them.
#pragma once

#include "geometry/strand_curve.h"

namespace rayleaf {

/// The ray's frame in local space.
struct StrandRay {
    Vec3d origin{0, 0, 0};                                       ///< near the shape
    Vec3d along{0, 0, 1}, across_x{1, 0, 0}, across_y{0, 1, 0};  ///< unit, orthogonal

    StrandRay() = default;
    StrandRay(const Vec3d& near_origin, const Vec3d& unit_direction);
    /// A segment in the ray's frame; radii stay.
    StrandSegment to_frame(const StrandSegment& local) const;

  private:
    /// Images of the axes.
    Double4 columns_[3] = {Double4(Vec4d(1, 0, 0, 0)), Double4(Vec4d(0, 1, 0, 0)), Double4(Vec4d(0, 0, 1, 0))};
};

}  // namespace rayleaf
