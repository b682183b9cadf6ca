#include "geometry/swept_curve_making.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "splines/curve_splines.h"

#include <algorithm>
#include <tuple>

namespace rayleaf {
namespace {

constexpr std::pair<const char*, CurveSplineType> kTypes[] = {
    {"BEZIER", CurveSplineType::Bezier}, {"NURBS", CurveSplineType::Nurbs}, {"POLY", CurveSplineType::Poly}};
constexpr std::pair<const char*, PointInterpolation> kInterpolations[] = {{"LINEAR", PointInterpolation::Linear},
                                                                          {"CARDINAL", PointInterpolation::Cardinal},
                                                                          {"BSPLINE", PointInterpolation::BSpline},
                                                                          {"EASE", PointInterpolation::Ease}};
constexpr std::pair<const char*, CurveDimensions> kDimensions[] = {{"2D", CurveDimensions::Two},
                                                                   {"3D", CurveDimensions::Three}};
constexpr std::pair<const char*, TwistMethod> kTwists[] = {
    {"Z_UP", TwistMethod::ZUp}, {"MINIMUM", TwistMethod::Minimum}, {"TANGENT", TwistMethod::Tangent}};
constexpr std::pair<const char*, ClosedTwist> kClosedTwists[] = {{"SPREAD", ClosedTwist::Spread},
                                                                 {"JUMP", ClosedTwist::Jump}};
constexpr std::pair<const char*, BevelFill> kFills[] = {
    {"FULL", BevelFill::Full}, {"BACK", BevelFill::Back}, {"FRONT", BevelFill::Front}, {"HALF", BevelFill::Half}};
constexpr std::pair<const char*, BevelMapping> kMappings[] = {
    {"RESOLUTION", BevelMapping::Resolution}, {"SEGMENTS", BevelMapping::Segments}, {"SPLINE", BevelMapping::Spline}};
constexpr std::pair<const char*, TaperRadius> kTapers[] = {
    {"OVERRIDE", TaperRadius::Override}, {"MULTIPLY", TaperRadius::Multiply}, {"ADD", TaperRadius::Add}};

constexpr const char* kSplines = "CurveSplines";

template <typename To, typename From>
std::vector<To> numbers(const char* argument, const std::optional<Array<From>>& array, py::ssize_t count) {
    if (!array) return {};
    check_shape(kSplines, argument, *array, {count});
    return {array->data(), array->data() + array->size()};
}

CurveSplines make_splines(const std::string& type, const Array<int32_t>& counts, const Array<double>& points,
                          const std::optional<Array<double>>& handles, const std::optional<Array<double>>& radii,
                          const std::optional<Array<double>>& tilts, const std::optional<Array<bool>>& straight,
                          int order, bool cyclic, bool endpoint, bool bezier, const std::string& radius_interpolation,
                          const std::string& tilt_interpolation, int resolution, int material_slot, bool smooth,
                          int fill_group, bool ends_at_seam) {
    check_shape(kSplines, "counts", counts, {-1});
    check_shape(kSplines, "points", points, {-1, 4});
    const py::ssize_t count = points.shape(0);
    CurveSplines splines;
    splines.type = named(kSplines, "type", type, kTypes);
    splines.nurbs = {order, cyclic, endpoint, bezier};
    for (const int32_t each : span_of(counts)) {
        if (each < 0) throw InputError(kSplines, "counts", std::to_string(each), "0 or more");
        splines.counts.push_back(static_cast<uint32_t>(each));
    }
    splines.points.reserve(static_cast<size_t>(count));
    for (const double* p = points.data(); p != points.data() + points.size(); p += 4)
        splines.points.emplace_back(p[0], p[1], p[2], p[3]);
    if (handles) {
        check_shape(kSplines, "handles", *handles, {count, 2, 3});
        splines.handles.reserve(2 * static_cast<size_t>(count));
        for (const double* p = handles->data(); p != handles->data() + handles->size(); p += 3)
            splines.handles.emplace_back(p[0], p[1], p[2]);
    }
    splines.radii = numbers<double>("radii", radii, count);
    splines.tilts = numbers<double>("tilts", tilts, count);
    splines.straight = numbers<uint8_t>("straight", straight, count);
    splines.radius_interpolation = named(kSplines, "radius_interpolation", radius_interpolation, kInterpolations);
    splines.tilt_interpolation = named(kSplines, "tilt_interpolation", tilt_interpolation, kInterpolations);
    splines.resolution = resolution;
    splines.material_slot = material_slot;
    splines.smooth = smooth;
    splines.fill_group = fill_group;
    splines.ends_at_seam = ends_at_seam;
    if (const auto problem = find_problem(splines))
        throw InputError(kSplines, problem->argument, problem->got, problem->wanted);
    return splines;
}

std::unique_ptr<SweptCurve> make_curve(const std::string& name, const std::vector<CurveSplines>& splines,
                                       const std::string& dimensions, const std::string& twist,
                                       const std::string& closed_twist, double bevel_depth, double extrude,
                                       double offset, const std::string& fill, int bevel_resolution,
                                       const std::optional<std::vector<CurveSplines>>& profile,
                                       const std::optional<CurveSplines>& taper, const std::string& taper_radius,
                                       bool taper_fits_bevel, double bevel_start, double bevel_end,
                                       const std::string& start_mapping, const std::string& end_mapping, bool fill_caps,
                                       const std::vector<int>& fill_materials) {
    SweptCurveDescription curve;
    curve.name = name;
    curve.splines = splines;
    curve.dimensions = named(name, "dimensions", dimensions, kDimensions);
    curve.twist = named(name, "twist", twist, kTwists);
    curve.closed_twist = named(name, "closed_twist", closed_twist, kClosedTwists);
    curve.bevel_depth = bevel_depth;
    curve.extrude = extrude;
    curve.offset = offset;
    curve.fill = named(name, "fill", fill, kFills);
    curve.bevel_resolution = bevel_resolution;
    curve.profile = profile;
    curve.taper = taper;
    curve.taper_radius = named(name, "taper_radius", taper_radius, kTapers);
    curve.taper_fits_bevel = taper_fits_bevel;
    curve.bevel_start = bevel_start;
    curve.bevel_end = bevel_end;
    curve.start_mapping = named(name, "start_mapping", start_mapping, kMappings);
    curve.end_mapping = named(name, "end_mapping", end_mapping, kMappings);
    curve.fill_caps = fill_caps;
    curve.fill_materials = fill_materials;
    if (const auto problem = find_problem(curve))
        throw InputError(name, problem->argument, problem->got, problem->wanted);
    return std::make_unique<SweptCurve>(std::move(curve));
}

}  // namespace

void bind_curves(py::module_& module) {
    using namespace py::literals;
    py::class_<CurveSplines>(module, "CurveSplines")
        .def(py::init(&make_splines), "type"_a, "counts"_a, "points"_a, "handles"_a = py::none(),
             "radii"_a = py::none(), "tilts"_a = py::none(), "straight"_a = py::none(), "order"_a = 4,
             "cyclic"_a = false, "endpoint"_a = false, "bezier"_a = false, "radius_interpolation"_a = "LINEAR",
             "tilt_interpolation"_a = "LINEAR", "resolution"_a = 12, "material_slot"_a = 0, "smooth"_a = true,
             "fill_group"_a = 0, "ends_at_seam"_a = false)
        .def("__len__", &CurveSplines::spline_count);
    py::class_<SweptCurve>(module, "SweptCurve")
        .def(py::init(&make_curve), "name"_a, "splines"_a, py::kw_only(), "dimensions"_a = "3D", "twist"_a = "MINIMUM",
             "closed_twist"_a = "SPREAD", "bevel_depth"_a = 0.0, "extrude"_a = 0.0, "offset"_a = 0.0, "fill"_a = "FULL",
             "bevel_resolution"_a = 4, "profile"_a = py::none(), "taper"_a = py::none(), "taper_radius"_a = "OVERRIDE",
             "taper_fits_bevel"_a = false, "bevel_start"_a = 0.0, "bevel_end"_a = 1.0, "start_mapping"_a = "RESOLUTION",
             "end_mapping"_a = "RESOLUTION", "fill_caps"_a = false, "fill_materials"_a = std::vector<int>())
        .def("begin", &SweptCurve::begin)
        .def("borders_cross", &SweptCurve::borders_cross, py::call_guard<py::gil_scoped_release>())
        .def_property_readonly("name", [](const SweptCurve& curve) { return curve.description().name; });
}

}  // namespace rayleaf
