// What a thread fills while it renders a tile: its pixels row by row, each with its samples in order.
#pragma once

#include "film/film_sums.h"
#include "film/sample_range.h"

#include <span>
#include <vector>

namespace rayleaf {

class TileSums {
  public:
    /// `x` and `y`: where the tile begins in `kept`, which gets the sums of finished pixels; it may be null.
    TileSums(int x, int y, int width, SampleRange samples, std::span<const Pass> passes, FilmSums* kept)
        : x_(x), y_(y), width_(width), samples_(samples), passes_(passes), kept_(kept) {}

    /// The next sample of the pixel at hand, or the first of the next one.
    void add(const PixelSample& sample) {
        sums_.add(sample, samples_.first + added_, passes_);
        if (++added_ == samples_.count) finish_pixel();
    }
    /// Of the pixels that are finished.
    std::span<const PixelValues> values() const { return values_; }

  private:
    int x_, y_, width_;
    SampleRange samples_;
    std::span<const Pass> passes_;
    FilmSums* kept_;
    PixelSums sums_;  ///< of the pixel at hand
    int added_ = 0;   ///< samples of it so far
    std::vector<PixelValues> values_;

    void finish_pixel() {
        const int number = static_cast<int>(values_.size());
        values_.push_back(sums_.values(passes_, samples_.count));
        if (kept_) kept_->add(x_ + number % width_, y_ + number / width_, samples_.count, sums_);
        sums_.clear(passes_);
        added_ = 0;
    }
};

}  // namespace rayleaf
