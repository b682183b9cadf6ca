// Asks for memory that is needed soon, while other work goes on.
#pragma once

#include <cstddef>

namespace rayleaf {

/// Brings the lines of the cache that hold `bytes` bytes from `first` on; beyond mapped memory nothing happens.
inline void prefetch_lines(const void* first, size_t bytes) {
    constexpr size_t kLine = 64;
    const char* const begin = static_cast<const char*>(first);
    for (size_t offset = 0; offset < bytes; offset += kLine) __builtin_prefetch(begin + offset);
    if (bytes > 0) __builtin_prefetch(begin + bytes - 1);
}

}  // namespace rayleaf
