// Which blocks of pixels take further samples where something is set that a picture may be off by: a target error, or a
// noise threshold.
//
// A target error is that of the report: the root mean square over pixels and channels of the difference to the
// converged picture, both clipped to [0, 1]. It is told by what the last doubling of a pixel's samples changed. The
// square of a change is, on average, what the doubling took away from the square of the error. Samples are spread
// evenly, so that falls with their number as n^-p, p being 1 or more, and 2^p - 1 times what is left was taken away.
// Two doublings tell p, for the whole picture. The least of all rounds holds: blocks that take further samples because
// they changed much change less the next time, whatever p is. Where p is well above 1, numbers of samples are powers of
// two: between them, samples are spread less evenly. Where it is not, squares of samples tell the error of a block, as
// of random ones; by how much less it is, doublings tell, again for the whole picture.
//
// A noise threshold is in Cycles' unit: the root mean square over pixels, of blocks that are noisy at all, of the
// standard error of their mean brightness (red + green + blue) over the root of that mean. Cycles estimates it from
// half of the samples, here squares of them tell it.
//
// After a round, `decide` divides what is missing (Neyman's allocation): where squares of errors fall as V n^-p and a
// sample costs c rays, n in proportion to (V / c)^(1 / (1 + p)) makes the least error for the number of rays. To stop
// each block as soon as it is good enough, as Cycles does, would not: equal errors everywhere cost as many samples as
// equal numbers of them with the same error of the whole. V is told by squares of samples, which settle sooner than
// changes, and by those of the blocks around, since a block that missed something rare looks calm; one that was done
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

/// Of some of a pixel's samples: colours, squares of brightness and of the channels, each added up.
struct PixelMoments {
    Vec3d color{0, 0, 0};
    double squares_of_brightness = 0, squares_of_channels = 0;
    Vec3d first{0, 0, 0}, first_two{0, 0, 0};  ///< colours of those, as far as they are here

    /// A sample by its number from 0 of all that the pixel takes.
    void add(const PixelSample& sample, int number);
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
    /// Samples of a pixel in the first round of a target error, of which two doublings are judged.
    static constexpr int kFirstRound = 4;
    static constexpr int kGroup = 8;  ///< pixels along the side of what samples cost alike; cut at the border

    /// Of a film; blocks begin at its lower left corner.
    ErrorBlocks(int width, int height, const ErrorGoal& goal);

    /// Of blocks that are not done yet what they should have next, `most` at most of a pixel; in parts, for one thread
    /// each. All blocks of a group are in one part.
    std::vector<std::vector<WindowSamples>> next(int most) const;
    /// Of all pixels, as far as one can see.
    double samples_missing(int most) const;
    /// After further samples of all of a block's pixels, row by row. Blocks may be added to by different threads.
    void add(const WindowSamples& block, std::span<const PixelMoments> pixels);
    /// How many rays the samples of a block took. Groups may be added to by different threads.
    void add_rays(const WindowSamples& block, uint64_t rays);
    /// After each round.
    void decide();
    /// Less is left for noise, where a shortcut makes an error.
    void set_target(double most) { goal_.most = most; }
    /// Estimate of the error of the picture as it is.
    double error() const;
    size_t bytes() const;

  private:
    struct Pixel {
        Vec3d color{0, 0, 0};   ///< of its samples, added up
        double squares = 0;     ///< of their channels; for a noise threshold, of their brightness
        Vec3f before{0, 0, 0};  ///< its mean colour after the last doubling

        /// Of what is displayed of its mean colour, for a channel that is as noisy as the mean of them.
        double displayed_squares(int samples) const;
        /// Of two samples or more, in Cycles' unit.
        double noise_square(int samples) const;
    };
    struct Block {
        int samples = 0;
        double needed = 0;         ///< samples; not fewer than these
        double variance = 0;       ///< of single samples, of its pixels added up
        int doubled = 0;           ///< samples after the last doubling that is judged; 0: none is
        double change = 0;         ///< squares of what it changed, the block's pixels and their channels added up
        double change_before = 0;  ///< of what the doubling before it changed
        double random = 0;         ///< of what it would be off by after them if samples were random
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
    std::vector<Pixel> pixels_;
    std::vector<Block> blocks_;
    std::vector<Cost> costs_;    ///< of groups
    double power_;               ///< p
    double against_random_ = 1;  ///< squares of errors, as a share of those of random samples

    size_t index(int column, int row) const {
        return static_cast<size_t>(row) * static_cast<size_t>(columns_) + static_cast<size_t>(column);
    }
    size_t group(int x, int y) const {
        return static_cast<size_t>(y / kGroup) * static_cast<size_t>(group_columns_) + static_cast<size_t>(x / kGroup);
    }
    Pixel& pixel_of(const Window& place, size_t number) {
        const size_t width = static_cast<size_t>(place.width), x = static_cast<size_t>(place.x) + number % width,
                     y = static_cast<size_t>(place.y) + number / width;
        return pixels_[y * static_cast<size_t>(width_) + x];
    }
    Window window(size_t index) const;
    double pixels(size_t index) const;
    int wanted(const Block& block, int most) const;
    void add_changes(Block& block, const Window& place, std::span<const PixelMoments> added);
    void judge_doublings();
    bool is_even() const;
    double squares_of_one(const Block& block) const;
    double squares(const Block& block) const;
    double numbers_of_all() const;
    double squares_of_all() const;
    double room() const;
    std::vector<double> worths() const;
    double whole(double samples) const;
    double samples_per_worth(std::span<const double> worths, double room) const;
};

}  // namespace rayleaf
