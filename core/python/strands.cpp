#include "geometry/strands.h"

#include "geometry/curve_fits.h"
#include "geometry/swept_curve_making.h"
#include "python/arrays.h"
#include "python/bindings.h"

#include <map>

namespace rayleaf {
namespace {

constexpr std::pair<const char*, StrandBasis> kBases[] = {{"LINEAR", StrandBasis::Linear},
                                                          {"CATMULL_ROM", StrandBasis::CatmullRom},
                                                          {"BSPLINE", StrandBasis::BSpline},
                                                          {"BEZIER", StrandBasis::Bezier}};
constexpr std::pair<const char*, StrandForm> kForms[] = {{"ROUND", StrandForm::Round},
                                                         {"RIBBON", StrandForm::Ribbon},
                                                         {"SPHERES", StrandForm::Spheres},
                                                         {"EMBREE_ROUND", StrandForm::EmbreeRound}};
constexpr std::pair<const char*, FacetLayout> kLayouts[] = {{"TRIANGLES", FacetLayout::Triangles},
                                                            {"QUADS", FacetLayout::Quads}};
constexpr std::pair<const char*, AttributeId StrandInfoIds::*> kInfos[] = {{"IS_STRAND", &StrandInfoIds::is_strand},
                                                                           {"INTERCEPT", &StrandInfoIds::intercept},
                                                                           {"LENGTH", &StrandInfoIds::length},
                                                                           {"THICKNESS", &StrandInfoIds::thickness}};

using StrandAttributes = std::map<int, Array<float>>;

void add_attributes(StrandArrays& arrays, const StrandAttributes& given, StrandDomain domain) {
    for (const auto& [id, array] : given) {
        check_shape(arrays.name, "attributes", array, {-1, -1});
        const std::span<const float> values = span_of(array);
        arrays.attributes.push_back({id, static_cast<int>(array.shape(1)), domain, {values.begin(), values.end()}});
    }
}

std::shared_ptr<Strands> make_strands(const std::string& name, const Array<double>& points, const Array<float>& radii,
                                      const Array<int32_t>& offsets, const std::string& basis, const std::string& form,
                                      const std::optional<Array<uint8_t>>& cyclic,
                                      const std::optional<Array<int32_t>>& material_slots, int spheres_per_segment,
                                      int uv, const StrandAttributes& attributes,
                                      const StrandAttributes& point_attributes, const std::map<std::string, int>& info,
                                      const std::optional<Array<double>>& moved_points, bool has_inside) {
    check_shape(name, "points", points, {-1, 3});
    check_shape(name, "radii", radii, {-1});
    check_shape(name, "offsets", offsets, {-1});
    StrandArrays arrays;
    arrays.name = name;
    arrays.points = span_of(points);
    arrays.radii = span_of(radii);
    arrays.offsets = span_of(offsets);
    arrays.basis = named(name, "basis", basis, kBases);
    arrays.form = named(name, "form", form, kForms);
    if (cyclic) {
        check_shape(name, "cyclic", *cyclic, {-1});
        arrays.cyclic = span_of(*cyclic);
    }
    if (material_slots) check_shape(name, "material_slots", *material_slots, {-1});
    if (material_slots) arrays.material_slots = span_of(*material_slots);
    if (moved_points) {
        check_shape(name, "moved_points", *moved_points, {-1, points.shape(0), 4});
        arrays.moved_points = span_of(*moved_points);
    }
    arrays.spheres_per_segment = spheres_per_segment;
    arrays.has_inside = has_inside;
    arrays.active_uv = uv;
    add_attributes(arrays, attributes, StrandDomain::Strand);
    add_attributes(arrays, point_attributes, StrandDomain::Point);
    for (const auto& [text, id] : info) arrays.info.*named(name, "info", text, kInfos) = id;
    return std::make_shared<Strands>(std::move(arrays));
}

}  // namespace

void bind_strands(py::module_& module) {
    using namespace py::literals;
    py::class_<Strands, Shape, std::shared_ptr<Strands>>(module, "Strands", "Many thin curves.")
        .def(py::init(&make_strands), "name"_a, "points"_a, "radii"_a, "offsets"_a, "basis"_a = "CATMULL_ROM",
             "form"_a = "ROUND", "cyclic"_a = py::none(), "material_slots"_a = py::none(), "spheres_per_segment"_a = 16,
             "uv"_a = -1, "attributes"_a = StrandAttributes(), "point_attributes"_a = StrandAttributes(),
             "info"_a = std::map<std::string, int>(), "moved_points"_a = py::none(), "has_inside"_a = true);
    module.def(
        "strand_tubes",
        [](const Strands& strands, int rings, int sides, const std::string& facets) {
            return strand_tubes(strands, rings, sides, named(strands.name(), "facets", facets, kLayouts));
        },
        "strands"_a, "rings"_a, "sides"_a, "facets"_a = "TRIANGLES");
    module.def(
        "strands_along",
        [](const SweptCurve& curve, const std::string& form, int spheres_per_segment) {
            const SweptCurveDescription& described = curve.description();
            return strands_along(described, named(described.name, "form", form, kForms), spheres_per_segment);
        },
        "curve"_a, "form"_a = "ROUND", "spheres_per_segment"_a = 16);
}

}  // namespace rayleaf
