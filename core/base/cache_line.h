// Data that one thread writes often has cache lines of its own, else other threads that read its neighbours would
// wait.
#pragma once

#include <cstddef>

namespace rayleaf {

/// Bytes, on x86 and most ARM processors. On others a wrong size only costs speed.
inline constexpr size_t kCacheLine = 64;

}  // namespace rayleaf
