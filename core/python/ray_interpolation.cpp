#include "scene/ray_interpolation.h"

#include "base/error.h"
#include "python/bindings.h"
#include "ri_tree/ray_cache_store.h"
#include "scene/description.h"

namespace rayleaf {
namespace {

constexpr std::pair<const char*, RayInterpolationMode> kModes[] = {
    {"OFF", RayInterpolationMode::Off}, {"AUTO", RayInterpolationMode::Auto}, {"ON", RayInterpolationMode::On}};

RayInterpolationMode mode_of(const std::string& wanted) {
    for (const auto& [name, mode] : kModes)
        if (wanted == name) return mode;
    throw InputError("ray interpolation", "mode", "'" + wanted + "'", "OFF, AUTO or ON");
}

const char* name_of(RayInterpolationMode wanted) {
    for (const auto& [name, mode] : kModes)
        if (mode == wanted) return name;
    return "OFF";
}

RayInterpolation make(const std::string& mode, double error, std::optional<double> distance_threshold,
                      std::optional<double> angle_threshold, std::optional<int> depth_limit,
                      std::optional<uint64_t> cache_bytes, std::optional<double> rays_per_cell) {
    RayInterpolation result{mode_of(mode), thresholds_for(error)};
    RayCacheSettings& thresholds = result.thresholds;
    thresholds.distance_threshold = distance_threshold.value_or(thresholds.distance_threshold);
    thresholds.angle_threshold = angle_threshold.value_or(thresholds.angle_threshold);
    thresholds.depth_limit = depth_limit.value_or(thresholds.depth_limit);
    thresholds.mixed_depth_limit = depth_limit.value_or(thresholds.mixed_depth_limit);
    thresholds.rays_per_cell = rays_per_cell.value_or(thresholds.rays_per_cell);
    thresholds.cache_bytes = cache_bytes.value_or(thresholds.cache_bytes);
    validate("ray interpolation", result);
    return result;
}

VolumeVisualisation make_volume(const std::string& kind, float density, const std::array<float, 3>& color) {
    VolumeVisualisation volume{VolumeVisualisation::Kind::Emission, density, Color(color[0], color[1], color[2])};
    if (kind == "ABSORPTION")
        volume.kind = VolumeVisualisation::Kind::Absorption;
    else if (kind != "EMISSION")
        throw InputError("volume visualisation", "kind", "'" + kind + "'", "EMISSION or ABSORPTION");
    return volume;
}

template <auto Member>
auto threshold() {
    return [](const RayInterpolation& interpolation) { return interpolation.thresholds.*Member; };
}

}  // namespace

void bind_ray_interpolation(py::module_& module) {
    using namespace py::literals;
    py::class_<RayInterpolation>(module, "RayInterpolation",
                                 "How rays against an object are interpolated; see core/scene/ray_interpolation.h.")
        .def(py::init(&make), "mode"_a = "OFF", "error"_a = kDefaultRayError, "distance_threshold"_a = py::none(),
             "angle_threshold"_a = py::none(), "depth_limit"_a = py::none(), "cache_bytes"_a = py::none(),
             "rays_per_cell"_a = py::none())
        .def("__eq__", [](const RayInterpolation& a, const RayInterpolation& b) { return a == b; })
        .def_property_readonly("mode", [](const RayInterpolation& each) { return name_of(each.mode); })
        .def_property_readonly("distance_threshold", threshold<&RayCacheSettings::distance_threshold>())
        .def_property_readonly("angle_threshold", threshold<&RayCacheSettings::angle_threshold>())
        .def_property_readonly("depth_limit", threshold<&RayCacheSettings::depth_limit>())
        .def_property_readonly("cache_bytes", threshold<&RayCacheSettings::cache_bytes>())
        .def_property_readonly("rays_per_cell", threshold<&RayCacheSettings::rays_per_cell>());
    py::class_<VolumeVisualisation>(module, "VolumeVisualisation",
                                    "A material that shows the length of rays inside an object.")
        .def(py::init(&make_volume), "kind"_a = "EMISSION", "density"_a = 1.0f,
             "color"_a = std::array<float, 3>{1.0f, 1.0f, 1.0f});
    py::class_<RayCacheStore, std::shared_ptr<RayCacheStore>>(module, "RayCacheStore",
                                                              "Ray caches that the caller keeps between renders.")
        .def(py::init<>())
        .def("of_scene", &RayCacheStore::of_scene, "name"_a)
        .def("next_frame", &RayCacheStore::next_frame)
        .def("count", &RayCacheStore::count)
        .def("bytes", &RayCacheStore::bytes);
}

}  // namespace rayleaf
