// What one thread writes often lies on lines of the processor's cache of its own: others that read their neighbours
// would wait for it.
#pragma once

#include <cstddef>

namespace rayleaf {

/// Bytes; x86 and most ARM processors. A larger one costs speed alone.
inline constexpr size_t kCacheLine = 64;

}  // namespace rayleaf
