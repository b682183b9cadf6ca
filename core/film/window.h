// A rectangle of pixels.
#pragma once

namespace rayleaf {

struct Window {
    int x = 0, y = 0, width = 0, height = 0;  ///< lower left corner and size
};

}  // namespace rayleaf
