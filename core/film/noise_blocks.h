// Which blocks of pixels are noisy still: what adaptive sampling decides by.
//
// The noise of a pixel is the standard error of its mean brightness (red + green + blue), over the root of that mean:
// what Cycles estimates from half of the samples, here from their squares. A block is done when the root mean square
// over its pixels falls below the threshold. The decision depends on the block's own samples alone, so neither threads
// nor tiles show. Samples are stopped by what they show, so a mean is biased a little, as in every adaptive sampler of
// this kind.
#pragma once

#include "film/pixel.h"
#include "film/window.h"

#include <cstdint>
#include <span>
#include <vector>

namespace rayleaf {

/// Sums over the samples of a pixel: of their brightness, and of its square.
struct PixelMoments {
    double sum = 0, squares = 0;

    void add(const PixelSample& sample);
    PixelMoments& operator+=(const PixelMoments& other);
    /// Of that many samples, two or more.
    double noise(int samples) const;
};

class NoiseBlocks {
  public:
    static constexpr int kSide = 8;  ///< pixels
    using Block = Window;            ///< in the film; cut at its borders

    /// Blocks of a film, all noisy; they begin at its lower left corner. No block is done before it has
    /// `least_samples`.
    NoiseBlocks(int width, int height, double threshold, int least_samples);

    /// Those that are not done, in order.
    std::vector<Block> noisy() const;
    size_t noisy_pixels() const;
    /// After further samples of all of a block's pixels, row by row: `samples` is how many each has now. Blocks may be
    /// added to by different threads.
    void add(const Block& block, std::span<const PixelMoments> moments, int samples);
    size_t bytes() const;

  private:
    int width_, height_, columns_;
    double threshold_;
    int least_samples_;
    std::vector<PixelMoments> moments_;  ///< of each pixel
    std::vector<uint8_t> noisy_;         ///< of each block

    Block block(size_t index) const;
};

}  // namespace rayleaf
