#include "python/bindings.h"
#include "python/differential_rows.h"

namespace rayleaf {
void bind_rays(py::module_& module) {
    using namespace py::literals;
    module.def(
        "transferred_differential",
        [](const Rows& incoming, const Vector& direction, double t, const Vector& normal) {
            return rows(differential(incoming).transferred(vec(direction), t, vec(normal)));
        },
        "incoming"_a, "direction"_a, "t"_a, "normal"_a,
        "A ray differential (dp_dx, dp_dy, dd_dx, dd_dy) moved along its ray to a plane.");
    module.def(
        "reflected_differential",
        [](const Rows& incoming, const Vector& direction, const Vector& normal, const Vector& dn_dx,
           const Vector& dn_dy) {
            return rows(reflected(differential(incoming), vec(direction), vec(normal), vec(dn_dx), vec(dn_dy)));
        },
        "incoming"_a, "direction"_a, "normal"_a, "dn_dx"_a, "dn_dy"_a, "The differential after a mirror.");
    module.def(
        "refracted_differential",
        [](const Rows& incoming, const Vector& direction, const Vector& normal, const Vector& dn_dx,
           const Vector& dn_dy, float eta) {
            return rows(refracted(differential(incoming), vec(direction), vec(normal), vec(dn_dx), vec(dn_dy), eta));
        },
        "incoming"_a, "direction"_a, "normal"_a, "dn_dx"_a, "dn_dy"_a, "eta"_a, "The differential after a refraction.");
}

}  // namespace rayleaf
