// The sums that a thread fills while it renders a tile: pixels row by row, each with its samples in order.
#pragma once

#include "film/error_blocks.h"
#include "film/film_sums.h"
#include "film/sample_range.h"
#include "film/window.h"

#include <span>
#include <utility>
#include <vector>

namespace rayleaf {

class TileSums {
  public:
    /// What is wanted of a tile's pixels beside their values.
    struct Wanted {
        FilmSums* sums = nullptr;  ///< gets the sums of finished pixels; null: nobody
        bool moments = false;      ///< what the error is estimated from
        bool mattes = false;       ///< what each pixel shows
        bool means = false;        ///< values are plain means (PixelSums::values)
    };

    /// `tile`: in the film.
    TileSums(const Window& tile, SampleRange samples, std::span<const Pass> passes, const Wanted& wanted)
        : tile_(tile), samples_(samples), passes_(passes), wanted_(wanted) {}

    /// Adds the next sample of the current pixel, or the first one of the next pixel.
    void add(const PixelSample& sample) {
        sums_.add(sample, samples_.first + added_, passes_);
        if (wanted_.moments) pixel_moments_.add(sample, samples_.first + added_);
        if (wanted_.mattes) add_mattes(sample.extras->mattes);
        if (++added_ == samples_.count) finish_pixel();
    }
    bool is_full() const {
        return values_.size() == static_cast<size_t>(tile_.width) * static_cast<size_t>(tile_.height);
    }
    /// The values of finished pixels.
    std::span<const PixelValues> values() const { return values_; }
    std::span<const PixelMoments> moments() const { return moments_; }
    std::span<const PixelMattes> mattes() const { return mattes_; }

  private:
    Window tile_;
    SampleRange samples_;
    std::span<const Pass> passes_;
    Wanted wanted_;
    PixelSums sums_;  ///< of the current pixel
    PixelMoments pixel_moments_;
    PixelMattes pixel_mattes_;
    int added_ = 0;  ///< samples of it so far
    std::vector<PixelValues> values_;
    std::vector<PixelMoments> moments_;
    std::vector<PixelMattes> mattes_;

    void add_mattes(std::span<const MatteRecord> records) {
        for (const MatteRecord& record : records)
            for (size_t kind = 0; kind < kMatteKinds; ++kind) pixel_mattes_[kind].add(record.ids[kind], record.weight);
    }
    void finish_pixel() {
        const int number = static_cast<int>(values_.size());
        values_.push_back(sums_.values(passes_, samples_.count, wanted_.means));
        if (wanted_.moments) moments_.push_back(std::exchange(pixel_moments_, {}));
        if (wanted_.mattes) mattes_.push_back(std::exchange(pixel_mattes_, {}));
        if (wanted_.sums) {
            const int x = tile_.x + number % tile_.width, y = tile_.y + number / tile_.width;
            wanted_.sums->add(x, y, samples_.count, sums_);
            if (wanted_.mattes) wanted_.sums->add_mattes(x, y, samples_.count, mattes_.back());
        }
        sums_.clear(passes_);
        added_ = 0;
    }
};

/// Of windows that are rendered together, one after the other.
class WindowSums {
  public:
    void add_window(TileSums sums) { windows_.push_back(std::move(sums)); }
    /// Adds the next sample of the current window, or the first one of the next.
    void add(const PixelSample& sample) {
        if (windows_[current_].is_full()) ++current_;
        windows_[current_].add(sample);
    }
    const TileSums& operator[](size_t window) const { return windows_[window]; }

  private:
    std::vector<TileSums> windows_;
    size_t current_ = 0;
};

}  // namespace rayleaf
