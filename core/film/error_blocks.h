// Which blocks of pixels are worse still than a picture may be whose error is set: Settings::target_error.
//
// The error is that of the report: the root mean square over pixels and channels of the difference to the converged
// picture, both clipped to [0, 1]. Every second sample belongs to a sequence of its own, so that a picture has two
// halves that know nothing of each other: as far as they differ, half of that the whole is off, evenly spread samples
// and rare bright ones included.
//
// After a round, `decide` divides what is missing: samples in proportion to the deviation of one, over the root of the
// rays that one takes, make the least error for the number of rays (Neyman's allocation). How noisy a block is its
// neighbours tell as well, since a block that missed something rare looks calm; one that was done goes on where others
// turn out to be noisier. It is called while nothing is added, and sums in the order of blocks: neither threads nor
// tiles show. Samples are stopped by what they show, so a mean is biased a little, as in film/noise_blocks.h.
#pragma once

#include "film/pixel.h"
#include "film/sample_range.h"
#include "film/window.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace rayleaf {

/// Colours of a pixel's samples, added up: the even and the odd ones.
struct HalfSums {
    Vec3d even{0, 0, 0}, odd{0, 0, 0};

    void add(const PixelSample& sample, bool is_odd);
    HalfSums& operator+=(const HalfSums& other);
};

class ErrorBlocks {
  public:
    /// Of a film; `target` is the error that is to be left.
    ErrorBlocks(int width, int height, double target);

    /// Of blocks that are not done yet, in order, what they should have next: `most` at most of a pixel.
    std::vector<WindowSamples> next(int most) const;
    /// Of all pixels, as far as one can see.
    double samples_missing(int most) const;
    /// After further samples of all of a block's pixels, row by row: `samples` is how many each has now, two or more.
    /// `rays` is how many these samples took. Blocks may be added to by different threads.
    void add(const Window& block, std::span<const HalfSums> pixels, int samples, uint64_t rays);
    /// After each round.
    void decide();
    /// Less is left for noise, where a shortcut makes an error.
    void set_target(double target) { target_ = target; }
    /// Estimate of the error of the picture as it is.
    double error() const;
    size_t bytes() const;

  private:
    struct Block {
        double squares = 0;  ///< of what its pixels' channels are off by, added up
        int samples = 0;
        uint64_t rays = 0;
        double needed = 0;  ///< samples; not fewer than these

        /// Of single samples, added up.
        double variance() const { return squares * samples; }
        /// Of all pixels' samples of one number, added up; a sample costs something beside its rays.
        double cost(double pixels) const { return pixels + static_cast<double>(rays) / std::max(samples, 1); }
    };
    int width_, height_, columns_;
    double target_;
    std::vector<HalfSums> sums_;  ///< of each pixel
    std::vector<Block> blocks_;

    size_t index(int column, int row) const {
        return static_cast<size_t>(row) * static_cast<size_t>(columns_) + static_cast<size_t>(column);
    }
    Window window(size_t index) const;
    double numbers(size_t index) const;
    double numbers_of_all() const { return 3.0 * width_ * height_; }
    double squares_of_all() const;
    std::vector<double> worths() const;
    double samples_per_worth(std::span<const double> worths, double room) const;
};

}  // namespace rayleaf
