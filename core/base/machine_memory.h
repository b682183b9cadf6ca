// How much memory the machine has for this process.
#pragma once

#include <cstdint>

namespace rayleaf {

/// Bytes: the machine's memory, or less where the process's control group may take less. Linux; elsewhere 4 GiB.
uint64_t machine_memory();

}  // namespace rayleaf
