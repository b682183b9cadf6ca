// The tiles of a picture, which threads take one by one.
#pragma once

#include "scene/settings.h"

#include <algorithm>
#include <vector>

namespace rayleaf {

/// The window cut into tiles, row by row from below.
inline std::vector<Window> tiles_of(const Window& window, int size) {
    std::vector<Window> tiles;
    for (int y = 0; y < window.height; y += size)
        for (int x = 0; x < window.width; x += size)
            tiles.push_back(
                {window.x + x, window.y + y, std::min(size, window.width - x), std::min(size, window.height - y)});
    return tiles;
}

}  // namespace rayleaf
