// The tiles of a picture, which threads take one by one, and their pixels.
#pragma once

#include "film/sample_range.h"
#include "scene/settings.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace rayleaf {

/// Pixels along the side of a tile, `most` at most, where each pixel takes so many samples. A tile is a few streams of
/// paths, and smaller where threads would have few tiles each: at the end, all wait for the slowest.
inline int tile_side(const Window& window, int samples, int threads, int most) {
    constexpr double kMostPaths = 4096, kLeastPaths = 512, kTilesOfThread = 32;
    const double paths = static_cast<double>(window.width) * window.height * samples;
    const double of_tile = std::clamp(paths / (threads * kTilesOfThread), kLeastPaths, kMostPaths);
    return std::clamp(static_cast<int>(std::sqrt(of_tile / samples)), 1, most);
}

/// The window cut into tiles, row by row from below.
inline std::vector<Window> tiles_of(const Window& window, int size) {
    std::vector<Window> tiles;
    for (int y = 0; y < window.height; y += size)
        for (int x = 0; x < window.width; x += size)
            tiles.push_back(
                {window.x + x, window.y + y, std::min(size, window.width - x), std::min(size, window.height - y)});
    return tiles;
}

/// Calls `visit` with the number of each window and each of its pixels, until it returns false; then returns false.
template <typename Visit>
bool for_each_pixel(std::span<const WindowSamples> windows, const Visit& visit) {
    for (size_t i = 0; i < windows.size(); ++i) {
        const Window& window = windows[i].window;
        for (int y = window.y; y < window.y + window.height; ++y)
            for (int x = window.x; x < window.x + window.width; ++x)
                if (!visit(i, x, y)) return false;
    }
    return true;
}

}  // namespace rayleaf
