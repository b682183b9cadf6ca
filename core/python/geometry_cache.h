// What the bindings say about the geometry cache, in more than one place.
#pragma once

#include "python/bindings.h"
#include "tessellation/geometry_cache.h"

namespace rayleaf {

constexpr std::pair<const char*, CacheMode> kCacheModes[] = {
    {"MULTI", CacheMode::Multi}, {"SINGLE", CacheMode::Single}, {"NONE", CacheMode::None}};

py::dict geometry_cache_statistics(const GeometryCacheStatistics& statistics);
/// Settings before the tracer that takes them, tools that take the tracer after it.
void bind_geometry_cache_settings(py::module_& module);
void bind_geometry_cache(py::module_& module);

}  // namespace rayleaf
