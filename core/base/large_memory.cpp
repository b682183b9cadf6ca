#include "base/large_memory.h"

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace rayleaf {

LargeMemory large_memory(size_t bytes, size_t small_bytes) {
    LargeMemory memory(static_cast<std::byte*>(::operator new[](bytes, std::align_val_t{kLargePage}, std::nothrow)));
#ifdef __linux__
    const size_t first = (small_bytes + kLargePage - 1) / kLargePage * kLargePage;
    // Only a hint: without large pages everything works as well.
    if (memory && first < bytes) madvise(memory.get() + first, bytes - first, MADV_HUGEPAGE);
#endif
    return memory;
}

}  // namespace rayleaf
