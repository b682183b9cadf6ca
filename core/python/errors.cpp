#include "base/error.h"
#include "python/bindings.h"

namespace rayleaf {

void bind_errors(py::module_& module) {
    py::register_exception<InputError>(module, "InputError", PyExc_ValueError);
}

}  // namespace rayleaf
