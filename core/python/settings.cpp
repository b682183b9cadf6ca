#include "scene/settings.h"

#include "base/error.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/geometry_cache.h"

namespace rayleaf {
namespace {

constexpr std::pair<const char*, PixelFilterKind> kFilters[] = {{"BOX", PixelFilterKind::Box},
                                                                {"GAUSSIAN", PixelFilterKind::Gaussian},
                                                                {"BLACKMAN_HARRIS", PixelFilterKind::BlackmanHarris}};

constexpr std::pair<const char*, IntegratorKind> kIntegrators[] = {{"PATH", IntegratorKind::Path},
                                                                   {"DISTRIBUTION", IntegratorKind::Distribution}};
constexpr std::pair<const char*, IndirectLight> kIndirect[] = {{"NONE", IndirectLight::None},
                                                               {"AMBIENT_OCCLUSION", IndirectLight::AmbientOcclusion},
                                                               {"COLOR_BLEEDING", IndirectLight::ColorBleeding}};

/// Binds an enum setting by its name in `table`.
template <typename Enum, size_t count>
void bind_choice(py::class_<Settings>& settings, const char* name, Enum Settings::*member,
                 const std::pair<const char*, Enum> (&table)[count]) {
    settings.def_property(
        name,
        [member, &table](const Settings& s) {
            for (const auto& [text, value] : table)
                if (value == s.*member) return std::string(text);
            return std::string();
        },
        [name, member, &table](Settings& s, const std::string& wanted) {
            s.*member = named("settings", name, wanted, table);
        });
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
    py::class_<Settings> settings_class(module, "Settings",
                                        "What an artist sets; see core/scene/settings.h for meaning and units.");
    settings_class
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
        .def_readwrite("part_x", &Settings::part_x)
        .def_readwrite("part_y", &Settings::part_y)
        .def_readwrite("part_width", &Settings::part_width)
        .def_readwrite("part_height", &Settings::part_height)
        .def_readwrite("first_sample", &Settings::first_sample)
        .def_readwrite("sample_count", &Settings::sample_count)
        .def_readwrite("noise_threshold", &Settings::noise_threshold)
        .def_readwrite("target_error", &Settings::target_error)
        .def_readwrite("least_samples", &Settings::least_samples)
        .def_readwrite("time_limit", &Settings::time_limit)
        .def_readwrite("keep_sums", &Settings::keep_sums)
        .def_readwrite("draft", &Settings::draft)
        .def_readwrite("seed", &Settings::seed)
        .def_readwrite("threads", &Settings::threads)
        .def_readwrite("tile_size", &Settings::tile_size)
        .def_readwrite("stream_paths", &Settings::stream_paths)
        .def_readwrite("max_bounces", &Settings::max_bounces)
        .def_readwrite("diffuse_bounces", &Settings::diffuse_bounces)
        .def_readwrite("glossy_bounces", &Settings::glossy_bounces)
        .def_readwrite("transmission_bounces", &Settings::transmission_bounces)
        .def_readwrite("transparent_bounces", &Settings::transparent_bounces)
        .def_readwrite("volume_bounces", &Settings::volume_bounces)
        .def_readwrite("roulette_start", &Settings::roulette_start)
        .def_readwrite("shadow_bias", &Settings::shadow_bias)
        .def_readwrite("clamp_direct", &Settings::clamp_direct)
        .def_readwrite("clamp_indirect", &Settings::clamp_indirect)
        .def_readwrite("film_transparent", &Settings::film_transparent)
        .def_readwrite("filter_glossy", &Settings::filter_glossy)
        .def_readwrite("reflective_caustics", &Settings::reflective_caustics)
        .def_readwrite("refractive_caustics", &Settings::refractive_caustics)
        .def_readwrite("film_glass_roughness", &Settings::film_glass_roughness)
        .def_readwrite("mist_start", &Settings::mist_start)
        .def_readwrite("mist_depth", &Settings::mist_depth)
        .def_readwrite("mist_falloff", &Settings::mist_falloff)
        .def_readwrite("occlusion_distance", &Settings::occlusion_distance)
        .def_readwrite("glossy_rays", &Settings::glossy_rays)
        .def_readwrite("light_rays", &Settings::light_rays)
        .def_readwrite("hemisphere_rays", &Settings::hemisphere_rays)
        .def_readwrite("irradiance_cache", &Settings::irradiance_cache)
        .def_readwrite("irradiance_error", &Settings::irradiance_error)
        .def_readwrite("filter_width", &Settings::filter_width)
        .def_readwrite("exposure", &Settings::exposure)
        .def_readwrite("resident_megabytes", &Settings::resident_megabytes)
        .def_readwrite("geometry_cache_megabytes", &Settings::geometry_cache_megabytes)
        .def_readwrite("tessellation_factor", &Settings::tessellation_factor)
        .def_readwrite("stochastic_levels", &Settings::stochastic_levels)
        .def_readwrite("importance_levels", &Settings::importance_levels)
        .def_readwrite("least_mirrored_spread", &Settings::least_mirrored_spread)
        .def_readwrite("ray_interpolation", &Settings::ray_interpolation)
        .def_property("passes", &pass_names, &set_passes);
    bind_choice(settings_class, "geometry_cache_mode", &Settings::geometry_cache_mode, kCacheModes);
    bind_choice(settings_class, "filter", &Settings::filter, kFilters);
    bind_choice(settings_class, "integrator", &Settings::integrator, kIntegrators);
    bind_choice(settings_class, "indirect", &Settings::indirect, kIndirect);
}

}  // namespace rayleaf
