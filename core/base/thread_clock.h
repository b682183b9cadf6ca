// Processor time of one thread.
#pragma once

namespace rayleaf {

/// That this thread has used so far, seconds.
double thread_seconds();

}  // namespace rayleaf
