// Shader programs; and, in the submodule `shading`, what tests need to run them and their closures on arrays.
#include "base/error.h"
#include "python/bindings.h"
#include "shading/operations_closure.h"
#include "shading/program.h"
#include "textures/texture_store.h"

namespace rayleaf {
namespace {

using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;

void bind_program(py::module_& module) {
    py::class_<Program, std::shared_ptr<Program>>(
        module, "Program", "A flat shader program. The operations are those of core/shading/operations.def.")
        .def(py::init<std::string>(), py::arg("name"))
        .def(
            "constant",
            [](Program& program, float x, float y, float z, float w) { return program.constant(Vec4f(x, y, z, w)); },
            py::arg("x"), py::arg("y"), py::arg("z"), py::arg("w"))
        .def(
            "operation",
            [](Program& program, const std::string& identifier, const std::vector<Register>& operands,
               const std::vector<int32_t>& ints, const std::vector<float>& floats,
               const std::string& text) { return program.operation(identifier, operands, ints, floats, text); },
            py::arg("identifier"), py::arg("operands") = std::vector<Register>{},
            py::arg("ints") = std::vector<int32_t>{}, py::arg("floats") = std::vector<float>{}, py::arg("text") = "")
        .def_property_readonly("name", &Program::name)
        .def_property_readonly("emits", &Program::emits)
        .def_property_readonly("may_be_transparent", &Program::may_be_transparent)
        .def_property_readonly("is_constant", &Program::is_constant);
}

}  // namespace

void bind_shading(py::module_& module) {
    bind_program(module);
}

}  // namespace rayleaf
