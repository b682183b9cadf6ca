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
};

}  // namespace rayleaf
