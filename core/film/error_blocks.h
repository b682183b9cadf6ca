// Which blocks of pixels take further samples where something is set that a picture may be off by: a target error, or a
// noise threshold.
//
// A target error is that of the report: the root mean square over pixels and channels of the difference to the
// converged picture, both clipped to [0, 1]. Every second sample belongs to a sequence of its own then, so that a
// picture has two halves that know nothing of each other: as far as they differ, half of that the whole is off, evenly
// spread samples included. A noise threshold is in Cycles' unit: the root mean square over pixels, of blocks that are
// noisy at all, of the standard error of their mean brightness (red + green + blue) over the root of that mean. Cycles
// estimates it from half of the samples, here squares of them tell it.
//
// After a round, `decide` divides what is missing: samples in proportion to the deviation of one, over the root of the
// rays that one takes, make the least error for the number of rays (Neyman's allocation). To stop each block as soon as
// it is good enough, as Cycles does, would not: equal errors everywhere cost as many samples as equal numbers of them
// with the same error of the whole. The deviation is told by squares of samples, which settle sooner than differences
// of halves, and by those of the blocks around, since a block that missed something rare looks calm; one that was done
// goes on where others turn out to be noisier. `decide` is called while nothing is added, and sums in the order of
// blocks: neither threads nor tiles show. Samples are stopped by what they show, so a mean is biased a little.
#pragma once

#include "film/pixel.h"
#include "film/sample_range.h"
#include "film/window.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace rayleaf {

/// Of a pixel's samples: colours of the even and the odd ones, and squares of brightness, each added up.
struct PixelMoments {
    Vec3d even{0, 0, 0}, odd{0, 0, 0};
    double squares = 0;

    void add(const PixelSample& sample, bool is_odd);
    PixelMoments& operator+=(const PixelMoments& other);
    double brightness(int samples) const { return sum(even + odd) / samples; }
    /// Square of what the mean brightness of that many samples, two or more, is off by.
    double variance(int samples) const;
    /// Of two samples or more, in Cycles' unit.
    double noise(int samples) const;

  private:
    static double sum(const Vec3d& color) { return color.x + color.y + color.z; }
};

/// What is to be left of which error.
struct ErrorGoal {
    enum class Unit : uint8_t { Displayed, CyclesNoise };
    Unit unit = Unit::Displayed;
    double most = 0;
    int least_samples = 1;  ///< of each pixel
};

class ErrorBlocks {
  public:
    static constexpr int kSide = 2;  ///< of a block, pixels
    static constexpr int kGroup =
        8;  ///< pixels along the side of what is rendered together; they are cut at the border

    /// Of a film; blocks begin at its lower left corner.
    ErrorBlocks(int width, int height, const ErrorGoal& goal);

    /// Of blocks that are not done yet what they should have next, `most` at most of a pixel; group by group.
    std::vector<std::vector<WindowSamples>> next(int most) const;
    /// Of all pixels, as far as one can see.
    double samples_missing(int most) const;
    /// After further samples of all of a block's pixels, row by row. Blocks may be added to by different threads.
    void add(const WindowSamples& block, std::span<const PixelMoments> pixels);
    /// How many rays the samples of blocks of one group took.
    void add_rays(std::span<const WindowSamples> blocks, uint64_t rays);
    /// After each round.
    void decide();
    /// Less is left for noise, where a shortcut makes an error.
    void set_target(double most) { goal_.most = most; }
    /// Estimate of the error of the picture as it is.
    double error() const;
    size_t bytes() const;

  private:
    struct Block {
        double squares = 0;   ///< of what its pixels, or their channels, are off by, added up
        double variance = 0;  ///< of single samples, of its pixels added up
        int samples = 0;
        double needed = 0;  ///< samples; not fewer than these
    };
    struct Cost {
        uint64_t rays = 0, samples = 0;

        /// A sample costs something beside its rays.
        double of_sample() const {
            return 1.0 + static_cast<double>(rays) / static_cast<double>(std::max(samples, uint64_t{1}));
        }
    };
    int width_, height_, columns_, rows_, group_columns_;
    ErrorGoal goal_;
    std::vector<PixelMoments> pixels_;
    std::vector<Block> blocks_;
    std::vector<Cost> costs_;  ///< of groups

    size_t index(int column, int row) const {
        return static_cast<size_t>(row) * static_cast<size_t>(columns_) + static_cast<size_t>(column);
    }
    size_t group(int x, int y) const {
        return static_cast<size_t>(y / kGroup) * static_cast<size_t>(group_columns_) + static_cast<size_t>(x / kGroup);
    }
    Window window(size_t index) const;
    double pixels(size_t index) const;
    int wanted(const Block& block, int most) const;
    double numbers_of_all() const;
    double squares_of_all() const;
    double room() const;
    std::vector<double> worths() const;
    double samples_per_worth(std::span<const double> worths, double room) const;
};

}  // namespace rayleaf
