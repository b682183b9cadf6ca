#include "trace/local_ray.h"

#include <limits>

namespace rayleaf {

double length_of(const Vec3d& direction) {
    const double squared = direction.dot(direction);
    if (squared > kSmallSquare && squared < kLargeSquare) return std::sqrt(squared);
    const double largest = max_abs(direction);
    return largest * (direction / largest).length();
}

RTCRay LocalRay::embree_ray() const {
    RTCRay ray;
    ray.org_x = float_origin.x;
    ray.org_y = float_origin.y;
    ray.org_z = float_origin.z;
    ray.tnear = 0.0f;
    ray.dir_x = float_direction.x;
    ray.dir_y = float_direction.y;
    ray.dir_z = float_direction.z;
    ray.time = time;
    ray.tfar = float_distance(t_max);
    ray.mask = ~0u;
    ray.id = kRayAlone;
    ray.flags = 0;
    return ray;
}

RTCRayHit LocalRay::embree_ray_hit() const {
    RTCRayHit result;
    result.ray = embree_ray();
    result.hit.geomID = result.hit.primID = result.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return result;
}

std::optional<RayInterval> inside_box(const Box3d& box, const Vec3d& origin, const Vec3d& direction) {
    RayInterval interval{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    for (int axis = 0; axis < 3; ++axis) {
        if (direction[axis] == 0.0) {
            if (origin[axis] < box.min[axis] || origin[axis] > box.max[axis]) return std::nullopt;
            continue;
        }
        const double inverse = 1.0 / direction[axis];
        const double a = (box.min[axis] - origin[axis]) * inverse, b = (box.max[axis] - origin[axis]) * inverse;
        interval.begin = std::max(interval.begin, std::min(a, b));
        interval.end = std::min(interval.end, std::max(a, b));
    }
    if (!(interval.begin <= interval.end)) return std::nullopt;
    return interval;
}

Maybe<LocalRay> clipped_ray(const Box3d& box, const Vec3d& origin, const Vec3d& direction, double t_min, double t_max) {
    Maybe<LocalRay> made;  // returned everywhere, so in its place: copies cost as much as the clipping
    if (box.isEmpty()) return made;
    const std::optional<RayInterval> interval = inside_box(box, origin, direction);
    if (!interval || interval->end < t_min || interval->begin > t_max) return made;
    LocalRay& ray = made.emplace();
    ray.origin = origin;
    ray.direction = direction;
    ray.t_min = t_min;
    ray.t_max = t_max;
    ray.speed = length_of(direction);
    const double inverse = 1.0 / ray.speed;
    ray.start = std::max(interval->begin, t_min) - kBackstep * inverse;
    ray.float_origin = Vec3f(origin + direction * ray.start);
    ray.float_direction = Vec3f(direction * inverse);
    const bool is_near = is_finite(ray.float_origin) && max_abs(ray.float_origin) <= kFarOff;
    if (!is_near || !is_finite(ray.float_direction) || !(max_abs(ray.float_direction) > 0.0f)) made.reset();
    return made;
}

}  // namespace rayleaf
