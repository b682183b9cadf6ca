// The extension module rayleaf._core. Each bound area has a file of its own; none holds an algorithm.
#include "python/bindings.h"

PYBIND11_MODULE(_core, module) {
    module.doc() = "Rayleaf's core: splines and meshes in, pixels out. Usable from plain Python.";
    rayleaf::bind_errors(module);
    rayleaf::bind_distribution(module);
    rayleaf::bind_lights(module);
    rayleaf::bind_rays(module);
    rayleaf::bind_sampling(module);
    rayleaf::bind_shading(module);
    rayleaf::bind_trace(module);
    rayleaf::bind_strands(module);
    rayleaf::bind_subdivision(module);
    rayleaf::bind_ri_tree(module);
    rayleaf::bind_rivals(module);
    rayleaf::bind_splines(module);
    rayleaf::bind_curves(module);
    rayleaf::bind_ray_interpolation(module);
    rayleaf::bind_scene(module);
    rayleaf::bind_settings(module);
    rayleaf::bind_session(module);
}
