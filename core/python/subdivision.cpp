#include "geometry/subdivision_surface.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "scene/material_displacement.h"

#include <map>

namespace rayleaf {
namespace {

constexpr std::pair<const char*, BorderCorners> kBorderCorners[] = {{"SMOOTH", BorderCorners::Smooth},
                                                                    {"SHARP", BorderCorners::Sharp}};
constexpr std::pair<const char*, SubdivisionScheme> kSchemes[] = {{"CATMULL_CLARK", SubdivisionScheme::CatmullClark},
                                                                  {"BILINEAR", SubdivisionScheme::Bilinear}};
constexpr std::pair<const char*, UvSmoothing> kUvSmoothings[] = {
    {"NONE", UvSmoothing::None},
    {"PRESERVE_CORNERS", UvSmoothing::KeepCorners},
    {"PRESERVE_CORNERS_AND_JUNCTIONS", UvSmoothing::KeepCornersJunctions},
    {"PRESERVE_CORNERS_JUNCTIONS_AND_CONCAVE", UvSmoothing::KeepCornersJunctionsConcave},
    {"PRESERVE_BOUNDARIES", UvSmoothing::KeepBoundaries},
    {"SMOOTH_ALL", UvSmoothing::All}};

using CageAttributes = std::map<int, Array<float>>;
template <typename T>
using Optional = std::optional<Array<T>>;

std::vector<CornerAttribute> attributes_of(const std::string& name, const char* argument, const CageAttributes& given) {
    std::vector<CornerAttribute> result;
    for (const auto& [id, array] : given) {
        check_shape(name, argument, array, {-1, -1});
        const std::span<const float> values = span_of(array);
        result.push_back({id, static_cast<int>(array.shape(1)), {values.begin(), values.end()}});
    }
    return result;
}

template <typename T>
std::span<const T> optional_span(const std::string& name, const char* argument, const Optional<T>& array) {
    if (!array) return {};
    check_numbers(name, argument, *array);
    return span_of(*array);
}

std::shared_ptr<SubdivisionSurface> make_subdivision(
    const std::string& name, const Array<float>& vertices, const Array<int32_t>& face_sizes,
    const Array<int32_t>& corners, const Optional<int32_t>& crease_edges, const Optional<float>& crease_sharpness,
    const Optional<int32_t>& crease_vertices, const Optional<float>& vertex_sharpness,
    const Optional<int32_t>& material_slots, const std::string& border_corners, const std::string& uv_smoothing,
    const CageAttributes& uv_maps, int uv, const CageAttributes& attributes, const Optional<float>& corner_normals,
    const std::string& scheme, const Optional<float>& moved_vertices) {
    check_shape(name, "vertices", vertices, {-1, 3});
    check_shape(name, "face_sizes", face_sizes, {-1});
    check_shape(name, "corners", corners, {-1});
    if (crease_edges) check_shape(name, "crease_edges", *crease_edges, {-1, 2});
    SubdivisionCage cage;
    cage.name = name;
    cage.vertices = span_of(vertices);
    cage.face_sizes = span_of(face_sizes);
    cage.corners = span_of(corners);
    cage.crease_edges = optional_span(name, "crease_edges", crease_edges);
    cage.crease_sharpness = optional_span(name, "crease_sharpness", crease_sharpness);
    cage.crease_vertices = optional_span(name, "crease_vertices", crease_vertices);
    cage.vertex_sharpness = optional_span(name, "vertex_sharpness", vertex_sharpness);
    cage.material_slots = optional_span(name, "material_slots", material_slots);
    if (corner_normals) check_shape(name, "corner_normals", *corner_normals, {corners.shape(0), 3});
    cage.corner_normals = optional_span(name, "corner_normals", corner_normals);
    if (moved_vertices) {
        check_shape(name, "moved_vertices", *moved_vertices, {-1, vertices.shape(0), 3});
        cage.moved_vertices = span_of(*moved_vertices);
    }
    cage.scheme = named(name, "scheme", scheme, kSchemes);
    cage.border_corners = named(name, "border_corners", border_corners, kBorderCorners);
    cage.uv_smoothing = named(name, "uv_smoothing", uv_smoothing, kUvSmoothings);
    cage.uv_maps = attributes_of(name, "uv_maps", uv_maps);
    cage.active_uv = uv;
    cage.attributes = attributes_of(name, "attributes", attributes);
    const py::gil_scoped_release released;
    return std::make_shared<SubdivisionSurface>(cage);
}

/// Calls `use` with the number, the element and the parameters of each place.
void for_places(const SubdivisionSurface& surface, const Array<int32_t>& elements, const Array<double>& parameters,
                const auto& use) {
    check_shape(surface.name(), "elements", elements, {-1});
    check_shape(surface.name(), "parameters", parameters, {elements.shape(0), 2});
    const auto count = static_cast<int32_t>(surface.element_count());
    for (py::ssize_t i = 0; i < elements.shape(0); ++i) {
        const int32_t element = elements.data()[i];
        if (element < 0 || element >= count)
            throw InputError(surface.name(), "elements", std::to_string(element), "0 to " + std::to_string(count - 1));
        use(i, static_cast<uint32_t>(element), parameters.data() + 2 * i);
    }
}

py::array_t<double> points(const SubdivisionSurface& surface, const Array<int32_t>& elements,
                           const Array<double>& parameters) {
    py::array_t<double> result(std::vector<py::ssize_t>{elements.size(), 6, 3});
    double* out = result.mutable_data();
    for_places(surface, elements, parameters, [&](py::ssize_t, uint32_t element, const double* uv) {
        const PatchPoint p = surface.evaluate(element, uv[0], uv[1]);
        for (const Vec3d& value : {p.position, p.du, p.dv, p.duu, p.duv, p.dvv})
            for (int axis = 0; axis < 3; ++axis) *out++ = value[axis];
    });
    return result;
}

py::array_t<float> values(const SubdivisionSurface& surface, int attribute, const Array<int32_t>& elements,
                          const Array<double>& parameters) {
    py::array_t<float> result(std::vector<py::ssize_t>{elements.size(), 4});
    float* out = result.mutable_data();
    for_places(surface, elements, parameters, [&](py::ssize_t, uint32_t element, const double* uv) {
        LocalHit hit;
        hit.primitive = element;
        hit.u = static_cast<float>(uv[0]);
        hit.v = static_cast<float>(uv[1]);
        const Vec4f value = surface.attribute(attribute, hit).value_or(Vec4f(0.0f));
        for (int channel = 0; channel < 4; ++channel) *out++ = value[channel];
    });
    return result;
}

}  // namespace

void bind_subdivision(py::module_& module) {
    using namespace py::literals;
    py::class_<SubdivisionSurface, Shape, std::shared_ptr<SubdivisionSurface>>(module, "SubdivisionSurface",
                                                                               "The limit of a polygon mesh.")
        .def(py::init(&make_subdivision), "name"_a, "vertices"_a, "face_sizes"_a, "corners"_a,
             "crease_edges"_a = py::none(), "crease_sharpness"_a = py::none(), "crease_vertices"_a = py::none(),
             "vertex_sharpness"_a = py::none(), "material_slots"_a = py::none(), "border_corners"_a = "SMOOTH",
             "uv_smoothing"_a = "PRESERVE_BOUNDARIES", "uv_maps"_a = CageAttributes(), "uv"_a = -1,
             "attributes"_a = CageAttributes(), "corner_normals"_a = py::none(), "scheme"_a = "CATMULL_CLARK",
             "moved_vertices"_a = py::none())
        .def("points", &points, "elements"_a, "parameters"_a)
        .def("values", &values, "attribute"_a, "elements"_a, "parameters"_a);
    module.def(
        "displaced",
        [](const std::shared_ptr<Shape>& shape, const std::shared_ptr<Program>& program, int object, int world) {
            const auto copy = std::make_shared<const Program>(*program);  // it may grow
            const py::gil_scoped_release released;
            return displaced(shape, {copy, object, world});
        },
        py::arg("shape").none(false), py::arg("program").none(false), "object"_a = -1, "world"_a = -1);
}

}  // namespace rayleaf
