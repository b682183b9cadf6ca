// The extension module rayleaf._core. Each bound area has a file of its own; none holds an algorithm.
#include "python/bindings.h"

#include <string>

namespace rayleaf {
namespace {

/// Throws ImportError without NumPy. It must come before any type is bound: pybind11 keeps the types of an import that
/// fails half-way, and every later one would stumble over them.
void require_numpy() {
    try {
        py::dtype::of<float>();  // loads NumPy's interface
    } catch (const py::error_already_set& error) {
        throw py::import_error("Rayleaf's core needs NumPy: " + std::string(py::str(error.value())));
    }
}

/// The versions of Rayleaf and of what it was built with, as CMake passes them.
void tell_versions(py::module_& module) {
    module.attr("__version__") = RAYLEAF_VERSION;
    py::dict built_with;
    built_with["Compiler"] = RAYLEAF_COMPILER;
    built_with["Embree"] = RAYLEAF_EMBREE_VERSION;
    built_with["OpenImageIO"] = RAYLEAF_OPENIMAGEIO_VERSION;
    built_with["OpenSubdiv"] = RAYLEAF_OPENSUBDIV_VERSION;
    built_with["OpenVDB"] = RAYLEAF_OPENVDB_VERSION;
    built_with["TBB"] = RAYLEAF_TBB_VERSION;
    module.attr("built_with") = built_with;
}

}  // namespace
}  // namespace rayleaf

PYBIND11_MODULE(_core, module) {
    module.doc() = "Rayleaf's core: splines and meshes in, pixels out. Usable from plain Python.";
    rayleaf::require_numpy();
    rayleaf::tell_versions(module);
    rayleaf::bind_errors(module);
    rayleaf::bind_denoiser(module);
    rayleaf::bind_distribution(module);
    rayleaf::bind_lights(module);
    rayleaf::bind_rays(module);
    rayleaf::bind_sampling(module);
    rayleaf::bind_shading(module);
    rayleaf::bind_trace(module);
    rayleaf::bind_strands(module);
    rayleaf::bind_subdivision(module);
    rayleaf::bind_vertex_normals(module);
    rayleaf::bind_volumes(module);
    rayleaf::bind_ri_tree(module);
    rayleaf::bind_splines(module);
    rayleaf::bind_curves(module);
    rayleaf::bind_ray_interpolation(module);
    rayleaf::bind_scene(module);
    rayleaf::bind_settings(module);
    rayleaf::bind_film(module);
    rayleaf::bind_session(module);
}
