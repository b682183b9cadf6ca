// Processor time of one thread.
#pragma once

namespace rayleaf {

/// Processor time that this thread has used so far, seconds.
double thread_seconds();

}  // namespace rayleaf
