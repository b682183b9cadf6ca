// Packets of rays against a tracer, for tests.
#pragma once

#include "python/bindings.h"
#include "trace/tracer.h"

#include <vector>

namespace rayleaf {

void bind_packets(py::module_& module);

/// What rays hit, and the surface points there: of several found together, of one alone.
struct FoundPoints {
    std::vector<Maybe<Hit>> hits;
    std::vector<SurfacePoint> points;
};
FoundPoints found_points(const Tracer& tracer, const std::vector<Ray>& rays, Visibility kind, SurfaceDetail detail);

}  // namespace rayleaf
