#include "lights/light_view.h"

namespace rayleaf {

Vec3d LightView::direction(size_t cell, size_t ray) {
    const auto place = [](size_t step, size_t half) {
        return (static_cast<double>(2 * step + half) + 0.5) / kSide - 1.0;  // two rays along each side of a cell
    };
    const double u = place(cell % kSide, ray % 2), v = place(cell / kSide, ray / 2);
    const double z = 1.0 - std::abs(u) - std::abs(v);
    const Vec3d result(z < 0.0 ? std::copysign(1.0 - std::abs(v), u) : u,
                       z < 0.0 ? std::copysign(1.0 - std::abs(u), v) : v, z);
    return result / result.length();
}

void LightView::set(size_t cell, size_t ray, const Vec3d& normal, const Vec3d& offset) {
    const double depth = normal.dot(offset);
    if (!(depth < 0.0)) return;
    const Vec3f plane(normal / depth);
    Planes& planes = planes_[cell];
    planes.x[ray] = plane.x;
    planes.y[ray] = plane.y;
    planes.z[ray] = plane.z;
}

bool LightView::is_open() const {
    return std::ranges::all_of(planes_, [](const Planes& each) {
        return largest_of(each.x * each.x + each.y * each.y + each.z * each.z) == 0.0f;
    });
}

}  // namespace rayleaf
