// The bound areas, and what their files share.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

namespace rayleaf {

namespace py = pybind11;

void bind_curves(py::module_& module);
void bind_denoiser(py::module_& module);
void bind_distribution(py::module_& module);
void bind_errors(py::module_& module);
void bind_film(py::module_& module);
void bind_lights(py::module_& module);
void bind_ray_interpolation(py::module_& module);
void bind_rays(py::module_& module);
void bind_ri_tree(py::module_& module);
void bind_sampling(py::module_& module);
void bind_scene(py::module_& module);
void bind_session(py::module_& module);
void bind_settings(py::module_& module);
void bind_shading(py::module_& module);
void bind_strands(py::module_& module);
void bind_subdivision(py::module_& module);
void bind_trace(py::module_& module);
void bind_splines(py::module_& module);
void bind_vertex_normals(py::module_& module);
void bind_volumes(py::module_& module);

}  // namespace rayleaf
