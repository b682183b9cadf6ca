#include "python/dicing_view.h"
#include "python/ray_arrays.h"
#include "python/timed_rays.h"
#include "rivals/bindings.h"
#include "rivals/embree_baseline.h"

namespace rayleaf {
namespace {

std::unique_ptr<EmbreeBaseline> make_baseline(const PatchSurface& surface, const std::string& primitive,
                                              double pixel_angle, const std::array<double, 3>& eye) {
    if (primitive != "GRID" && primitive != "TRIANGLE")
        throw InputError("Embree", "primitive", "'" + primitive + "'", "GRID or TRIANGLE");
    constexpr double kFinest = 1e-6;  // all grids are held at once
    if (!(pixel_angle >= kFinest)) throw InputError("Embree", "pixel_angle", number_text(pixel_angle), "1e-6 or more");
    return std::make_unique<EmbreeBaseline>(surface, view_from(pixel_angle, eye),
                                            primitive == "GRID" ? EmbreePrimitive::Grid : EmbreePrimitive::Triangle);
}

py::tuple timed(const EmbreeBaseline& baseline, const Array<double>& origins, const Array<double>& directions,
                const Array<float>& width, const Array<float>& spread, const Array<uint32_t>& starts) {
    const std::vector<Ray> rays = whole_rays(origins, directions, width, spread, starts);
    check_for_embree(rays);
    return timed_rays(rays, [&](const Ray& ray) { return baseline.closest_t(ray); });
}

}  // namespace

void bind_baseline(py::module_& module) {
    py::class_<EmbreeBaseline>(module, "EmbreeBaseline", "A surface's facets as Embree's own grids or triangles.")
        .def(py::init(&make_baseline), py::arg("surface"), py::arg("primitive"), py::arg("pixel_angle") = 1e-3,
             py::arg("eye") = std::array<double, 3>{0, 0, 0})
        .def(py::init<const TriangleMesh&>(), py::arg("mesh"))
        .def_property_readonly("bytes", &EmbreeBaseline::bytes)
        .def("timed_closest", &timed, py::arg("origins"), py::arg("directions"), py::arg("width") = float_number(0.0f),
             py::arg("spread") = float_number(0.0f), py::arg("starts") = Array<uint32_t>(0),
             "(processor seconds on one thread, t)");
}

}  // namespace rayleaf
