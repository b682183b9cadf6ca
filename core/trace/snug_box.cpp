#include "trace/snug_box.h"

#include "trace/local_ray.h"

#include <algorithm>

namespace rayleaf {
namespace {

/// The point that lies farthest by a measure.
template <typename Measure>
const Vec3d& extreme_point(std::span<const Vec3d> points, const Measure& measure) {
    return *std::ranges::max_element(points, {}, measure);
}

/// Around points, along a direction, the normal of a plane that it lies in, and across both.
SnugBox box_along(const Vec3d& direction, const Vec3d& normal, std::span<const Vec3d> points) {
    SnugBox box{Box3d()};
    box.axis[0] = direction;
    box.axis[1] = normal;
    box.axis[2] = direction.cross(normal);
    for (size_t i = 0; i < 3; ++i) {
        const auto [least, most] =
            std::ranges::minmax_element(points, {}, [&](const Vec3d& point) { return point.dot(box.axis[i]); });
        box.low[i] = least->dot(box.axis[i]) - kBoxPadding;
        box.high[i] = most->dot(box.axis[i]) + kBoxPadding;
    }
    return box;
}

}  // namespace

SnugBox::SnugBox(const Box3d& box) : low{box.min.x, box.min.y, box.min.z}, high{box.max.x, box.max.y, box.max.z} {}

SnugBox::SnugBox(const Box3d& box, std::span<const Vec3d> points) : SnugBox(box) {
    if (points.empty()) return;
    const auto from = [](const Vec3d& place) { return [&](const Vec3d& point) { return (point - place).length2(); }; };
    const Vec3d& a = extreme_point(points, from(box.center()));
    const Vec3d& b = extreme_point(points, from(a));
    const Vec3d& c = extreme_point(points, [&](const Vec3d& point) { return (point - a).cross(b - a).length2(); });
    const Vec3d normal = (b - a).cross(c - a);
    if (!(normal.length() > 0.0)) return;  // all on one line
    for (const Vec3d& edge : {b - a, c - a, c - b}) {
        const SnugBox turned = box_along(edge.normalized(), normal.normalized(), points);
        if (turned.half_area() < half_area()) *this = turned;
    }
}

double SnugBox::half_area() const {
    return rayleaf::half_area(Box3d(Vec3d(low[0], low[1], low[2]), Vec3d(high[0], high[1], high[2])));
}

}  // namespace rayleaf
