// Whether rays cross a closed shell in turn: in, out, in, out. A ray that leaves without having entered, or twice
// without coming back, has passed between facets. For tests and benchmarks.
#pragma once

#include "rays/ray.h"
#include "trace/tracer.h"

#include <cstdint>

namespace rayleaf {

enum class ShellSide : uint8_t { Inside, Outside };

/// True if the ray, which starts on the given side of everything, finds crossings that no closed shell has. Crossings
/// nearer to each other than `merge` (world units) count as one: at an edge both facets may be found.
bool finds_crack(const Tracer& tracer, const Ray& ray, ShellSide start, double merge);

}  // namespace rayleaf
