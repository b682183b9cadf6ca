#include "python/geometry_cache.h"

#include "base/error.h"
#include "python/arrays.h"
#include "python/ray_footprints.h"
#include "trace/shell_check.h"
#include "trace/tracer.h"

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

GeometryCacheSettings make_settings(double megabytes, const std::string& mode, float factor, float distance,
                                    bool stochastic, double resident_megabytes) {
    GeometryCacheSettings settings;
    settings.budget = budget_from_megabytes(megabytes);
    settings.mode = named("geometry cache", "mode", mode, kCacheModes);
    settings.rule.factor = factor;
    settings.rule.distance = distance;
    settings.rule.rounding = stochastic ? LevelRule::Rounding::Stochastic : LevelRule::Rounding::Up;
    settings.resident_budget = budget_from_megabytes(resident_megabytes);
    return settings;
}

py::array_t<bool> cracks(const Tracer& tracer, const Array<double>& origins, const Array<double>& directions,
                         const Array<float>& width, const Array<float>& spread, bool inside, double merge) {
    const RayArrays rays{origins, directions, number(0.0), number(std::numeric_limits<double>::infinity()),
                         width,   spread};
    rays.check();
    py::array_t<bool> result(rays.size());
    bool* out = result.mutable_data();
    const ShellSide start = inside ? ShellSide::Inside : ShellSide::Outside;
    const py::gil_scoped_release released;
    tbb::parallel_for(size_t{0}, rays.size(), [&](size_t i) { out[i] = finds_crack(tracer, rays[i], start, merge); });
    return result;
}

}  // namespace

py::dict geometry_cache_statistics(const GeometryCacheStatistics& s) {
    using namespace py::literals;
    constexpr const char* kNames[kStoredLevels] = {"coarse", "medium", "fine"};
    const auto told = [](const LevelCounters& counters, uint64_t vertices) {
        const auto lookups = static_cast<double>(std::max(counters.lookups - counters.cold, uint64_t{1}));
        return py::dict("lookups"_a = counters.lookups, "diced"_a = counters.diced, "cold"_a = counters.cold,
                        "misses"_a = counters.recomputed(), "hit_rate"_a = 1.0 - counters.recomputed() / lookups,
                        "vertices_recomputed"_a = counters.recomputed() * vertices, "bytes"_a = counters.bytes,
                        "bypassed"_a = counters.bypassed);
    };
    py::dict levels;
    for (int level = 0; level < kStoredLevels; ++level)
        levels[kNames[level]] = told(s.levels[level], kLevelVertices[level]);
    return py::dict("levels"_a = levels, "parts"_a = told(s.parts, kLevelVertices[kFine]), "splits"_a = s.splits,
                    "bytes"_a = s.bytes, "budget"_a = s.budget, "cold_counted"_a = s.cold_counted,
                    "vertices_diced"_a = s.vertices_diced(), "vertices_recomputed"_a = s.vertices_recomputed());
}

void bind_geometry_cache_settings(py::module_& module) {
    py::class_<GeometryCacheSettings>(module, "GeometryCacheSettings", "Budget, mode and rule of levels.")
        .def(py::init(&make_settings), py::arg("megabytes") = 30.0, py::arg("mode") = "MULTI", py::arg("factor") = 1.0f,
             py::arg("distance") = 0.1f, py::arg("stochastic") = false, py::arg("resident_megabytes") = 0.0);
}

void bind_geometry_cache(py::module_& module) {
    module.def("cracks", &cracks, py::arg("tracer"), py::arg("origins"), py::arg("directions"), py::arg("width"),
               py::arg("spread"), py::arg("inside"), py::arg("merge") = 1e-6,
               "Which rays find crossings that no closed shell has.");
}

}  // namespace rayleaf
