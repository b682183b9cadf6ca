#include "trace/strand_frame.h"

#include <cmath>

namespace rayleaf {

StrandRay::StrandRay(const Vec3d& near_origin, const Vec3d& unit_direction)
    : origin(near_origin), along(unit_direction) {
    // Duff et al. 2017, as base/vector.h has it for floats.
    const double sign = std::copysign(1.0, along.z), a = -1.0 / (sign + along.z), b = along.x * along.y * a;
    across_x = Vec3d(1.0 + sign * along.x * along.x * a, sign * b, -sign * along.x);
    across_y = Vec3d(b, sign + along.y * along.y * a, -along.y);
    for (int axis = 0; axis < 3; ++axis)
        columns_[axis] = Double4(Vec4d(across_x[axis], across_y[axis], along[axis], 0.0));
}

StrandSegment StrandRay::to_frame(const StrandSegment& local) const {
    StrandSegment result;
    for (int i = 0; i < 4; ++i) {
        const Vec3d p = axis_point(local.points[i]) - origin;
        const Double4 place = columns_[0] * p.x + columns_[1] * p.y + columns_[2] * p.z;
        result.points[i] = StrandPoint(place + Double4(Vec4d(0.0, 0.0, 0.0, local.points[i].w)));
    }
    return result;
}

}  // namespace rayleaf
