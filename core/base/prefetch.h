// Asks for memory that is needed soon, while other work goes on.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rayleaf {

/// Brings `bytes` bytes from `first` on into the processor's cache, line by line. Addresses that are not mapped do no
/// harm.
inline void prefetch_lines(const void* first, size_t bytes) {
    constexpr size_t kLine = 64;
    const char* const begin = static_cast<const char*>(first);
    const size_t before = reinterpret_cast<uintptr_t>(first) % kLine;  // of the first line
    for (size_t offset = 0; offset < bytes + before; offset += kLine) __builtin_prefetch(begin - before + offset);
}

}  // namespace rayleaf
