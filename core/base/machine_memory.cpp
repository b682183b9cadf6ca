#include "base/machine_memory.h"

#include <algorithm>
#include <fstream>

#include <unistd.h>

namespace rayleaf {

uint64_t machine_memory() {
    constexpr uint64_t kUnknown = uint64_t{4} << 30;
    const long pages = sysconf(_SC_PHYS_PAGES), page_size = sysconf(_SC_PAGESIZE);
    uint64_t bytes =
        pages > 0 && page_size > 0 ? static_cast<uint64_t>(pages) * static_cast<uint64_t>(page_size) : kUnknown;
    // Empty, or the word "max", if there is no limit.
    std::ifstream limit_file("/sys/fs/cgroup/memory.max");
    uint64_t limit = 0;
    if (limit_file >> limit) bytes = std::min(bytes, limit);
    return bytes;
}

}  // namespace rayleaf
