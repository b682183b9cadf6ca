// The bound areas of the module rayleaf_rivals.
#pragma once

#include "python/bindings.h"

namespace rayleaf {

void bind_baseline(py::module_& module);
void bind_rivals(py::module_& module);

}  // namespace rayleaf
