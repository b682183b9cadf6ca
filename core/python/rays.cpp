#include "python/arrays.h"
#include "python/bindings.h"
#include "rays/ray_differential.h"

namespace rayleaf {
namespace {

using Vector = std::array<float, 3>;

Vec3f vec(const Vector& v) {
    return {v[0], v[1], v[2]};
}
Vector tuple(const Vec3f& v) {
    return {v.x, v.y, v.z};
}

RayDifferential from_rows(const std::array<Vector, 4>& rows) {
    return {vec(rows[0]), vec(rows[1]), vec(rows[2]), vec(rows[3])};
}
std::array<Vector, 4> rows(const RayDifferential& d) {
    return {tuple(d.dp_dx), tuple(d.dp_dy), tuple(d.dd_dx), tuple(d.dd_dy)};
}

}  // namespace

void bind_rays(py::module_& module) {
    using namespace py::literals;
    module.def(
        "transferred_differential",
        [](const std::array<Vector, 4>& incoming, const Vector& direction, double t, const Vector& normal) {
            return rows(from_rows(incoming).transferred(vec(direction), t, vec(normal)));
        },
        "incoming"_a, "direction"_a, "t"_a, "normal"_a,
        "A ray differential (dp_dx, dp_dy, dd_dx, dd_dy) moved along its ray to a plane.");
    module.def(
        "reflected_differential",
        [](const std::array<Vector, 4>& incoming, const Vector& direction, const Vector& normal, const Vector& dn_dx,
           const Vector& dn_dy) {
            return rows(reflected(from_rows(incoming), vec(direction), vec(normal), vec(dn_dx), vec(dn_dy)));
        },
        "incoming"_a, "direction"_a, "normal"_a, "dn_dx"_a, "dn_dy"_a, "The differential after a mirror.");
    module.def(
        "refracted_differential",
        [](const std::array<Vector, 4>& incoming, const Vector& direction, const Vector& normal, const Vector& dn_dx,
           const Vector& dn_dy, float eta) {
            return rows(refracted(from_rows(incoming), vec(direction), vec(normal), vec(dn_dx), vec(dn_dy), eta));
        },
        "incoming"_a, "direction"_a, "normal"_a, "dn_dx"_a, "dn_dy"_a, "eta"_a, "The differential after a refraction.");
}

}  // namespace rayleaf
