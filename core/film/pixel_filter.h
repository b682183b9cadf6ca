// Where in a pixel's surroundings a sample falls. The filter is sampled instead of splatted: each sample belongs to one
// pixel with weight 1, so tiles share no pixel and need no order (Ernst et al. 2006, filter importance sampling).
#pragma once

#include "base/vector.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace rayleaf {

enum class PixelFilterKind : uint8_t { Box, Gaussian, BlackmanHarris };

class PixelFilter {
  public:
    /// `width`: the number on Blender's panel, pixels; the whole filter is `support(kind)` times as wide.
    /// 0 puts every sample at the pixel's centre.
    PixelFilter(PixelFilterKind kind, float width);

    /// Full width over the number on the panel: a window that falls to 0 looks narrower than it is (as Cycles counts).
    static float support(PixelFilterKind kind);

    /// Offset from the pixel's centre, pixels, for `random` in [0,1)².
    Vec2d offset(const Vec2f& random) const { return {offset(random.x), offset(random.y)}; }

  private:
    static constexpr int kEntries = 256;
    std::array<float, kEntries + 1> inverse_;  ///< offsets at equal steps of the cumulative filter

    double offset(float random) const {
        const float scaled = random * kEntries;
        const int cell = std::min(static_cast<int>(scaled), kEntries - 1);
        const float inside = scaled - static_cast<float>(cell);
        const auto i = static_cast<size_t>(cell);
        return inverse_[i] + (inverse_[i + 1] - inverse_[i]) * inside;
    }
};

}  // namespace rayleaf
