// Some of a pixel's samples.
#pragma once

namespace rayleaf {

struct SampleRange {
    int first = 0, count = 0;  ///< by their numbers from 0
};

}  // namespace rayleaf
