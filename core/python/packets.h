// Packets of rays against a tracer, for tests.
#pragma once

#include "python/bindings.h"

namespace rayleaf {

void bind_packets(py::module_& module);

}  // namespace rayleaf
