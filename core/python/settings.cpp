#include "scene/settings.h"

#include "base/error.h"
#include "python/bindings.h"

namespace rayleaf {
namespace {

constexpr std::pair<const char*, PixelFilterKind> kFilters[] = {{"BOX", PixelFilterKind::Box},
                                                                {"GAUSSIAN", PixelFilterKind::Gaussian},
                                                                {"BLACKMAN_HARRIS", PixelFilterKind::BlackmanHarris}};

std::string filter_name(const Settings& settings) {
    for (const auto& [name, kind] : kFilters)
        if (kind == settings.filter) return name;
    return {};
}

void set_filter(Settings& settings, const std::string& wanted) {
    for (const auto& [name, kind] : kFilters)
        if (wanted == name) {
            settings.filter = kind;
            return;
        }
    throw InputError("settings", "filter", "'" + wanted + "'", "BOX, GAUSSIAN or BLACKMAN_HARRIS");
}

std::vector<std::string> pass_names(const Settings& settings) {
    std::vector<std::string> names;
    for (const Pass pass : settings.passes) names.emplace_back(info(pass).identifier);
    return names;
}

void set_passes(Settings& settings, const std::vector<std::string>& names) {
    std::vector<Pass> passes;
    for (const std::string& name : names) {
        const std::optional<Pass> pass = find_pass(name);
        if (!pass) throw InputError("settings", "passes", "'" + name + "'", "a pass of the table in film/passes.def");
        passes.push_back(*pass);
    }
    settings.passes = std::move(passes);
}

}  // namespace

void bind_settings(py::module_& module) {
    py::class_<Settings>(module, "Settings", "What an artist sets; see core/scene/settings.h for meaning and units.")
        .def(py::init([](const py::kwargs& values) {
            auto settings = py::cast(Settings{});
            for (const auto& [name, value] : values) {
                if (!py::hasattr(settings, name))
                    throw InputError("settings", py::cast<std::string>(name), "unknown",
                                     "a setting of core/scene/settings.h");
                settings.attr(name) = value;
            }
            return settings.cast<Settings>();
        }))
        .def_readwrite("width", &Settings::width)
        .def_readwrite("height", &Settings::height)
        .def_readwrite("crop_x", &Settings::crop_x)
        .def_readwrite("crop_y", &Settings::crop_y)
        .def_readwrite("crop_width", &Settings::crop_width)
        .def_readwrite("crop_height", &Settings::crop_height)
        .def_readwrite("samples", &Settings::samples)
        .def_readwrite("seed", &Settings::seed)
        .def_readwrite("threads", &Settings::threads)
        .def_readwrite("tile_size", &Settings::tile_size)
        .def_readwrite("max_bounces", &Settings::max_bounces)
        .def_readwrite("diffuse_bounces", &Settings::diffuse_bounces)
        .def_readwrite("glossy_bounces", &Settings::glossy_bounces)
        .def_readwrite("transmission_bounces", &Settings::transmission_bounces)
        .def_readwrite("transparent_bounces", &Settings::transparent_bounces)
        .def_readwrite("roulette_start", &Settings::roulette_start)
        .def_readwrite("clamp_direct", &Settings::clamp_direct)
        .def_readwrite("clamp_indirect", &Settings::clamp_indirect)
        .def_readwrite("film_transparent", &Settings::film_transparent)
        .def_property("filter", &filter_name, &set_filter)
        .def_readwrite("filter_width", &Settings::filter_width)
        .def_readwrite("exposure", &Settings::exposure)
        .def_property("passes", &pass_names, &set_passes);
}

}  // namespace rayleaf
