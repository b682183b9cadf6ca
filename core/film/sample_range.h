// Some of a pixel's samples.
#pragma once

#include "film/window.h"

namespace rayleaf {

struct SampleRange {
    int first = 0, count = 0;  ///< by their numbers from 0
};

/// The next samples of some pixels.
struct WindowSamples {
    Window window;
    SampleRange samples;
    int taken = 0;  ///< before

    uint64_t paths() const {
        return static_cast<uint64_t>(window.width) * static_cast<uint64_t>(window.height) *
               static_cast<uint64_t>(samples.count);
    }
};

}  // namespace rayleaf
