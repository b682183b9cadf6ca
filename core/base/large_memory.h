// Memory for large tables that are read and written here and there: in large pages where the system has them, so that
// first use and address translation cost little.
#pragma once

#include <cstddef>
#include <memory>
#include <new>

namespace rayleaf {

inline constexpr size_t kLargePage = size_t{1} << 21;

struct LargeMemoryDeleter {
    void operator()(std::byte* memory) const { ::operator delete[](memory, std::align_val_t{kLargePage}); }
};
/// Aligned to kLargePage.
using LargeMemory = std::unique_ptr<std::byte[], LargeMemoryDeleter>;

/// Not initialised; null if there is none. It is taken from the system as it is used: what lies in the first
/// `small_bytes` by small pages, so that a table of which little is used stays small.
LargeMemory large_memory(size_t bytes, size_t small_bytes);

}  // namespace rayleaf
