// The sums that a thread fills while it renders windows, one after the other: pixels row by row, each with its samples
// in order.
#pragma once

#include "film/error_blocks.h"
#include "film/film_sums.h"
#include "film/sample_range.h"

#include <span>
#include <utility>
#include <vector>

namespace rayleaf {

class WindowSums {
  public:
    /// What is wanted of pixels beside their values.
    struct Wanted {
        FilmSums* sums = nullptr;  ///< gets the sums of finished pixels; null: nobody
        bool moments = false;      ///< what the error is estimated from
        bool mattes = false;       ///< what each pixel shows
        bool means = false;        ///< values are plain means (PixelSums::values)
    };
    /// Of a window's finished pixels.
    struct Sums {
        std::vector<PixelValues> values;
        std::vector<PixelMoments> moments;
        std::vector<PixelMattes> mattes;
    };

    /// `windows`: in the film. They and `passes` must stay.
    WindowSums(std::span<const WindowSamples> windows, std::span<const Pass> passes, const Wanted& wanted)
        : windows_(windows), passes_(passes), wanted_(wanted), sums_(windows.size()) {}

    /// Adds the next sample of the current pixel, or the first one of the next pixel.
    void add(const PixelSample& sample) {
        if (is_full(current_)) ++current_;
        const SampleRange& samples = windows_[current_].samples;
        const int number = samples.first + added_;
        pixel_.add(sample, number, passes_);
        if (wanted_.moments) moments_.add(sample, number);
        if (wanted_.mattes) add_mattes(sample.extras->mattes);
        if (++added_ == samples.count) finish_pixel();
    }
    const Sums& operator[](size_t window) const { return sums_[window]; }

  private:
    std::span<const WindowSamples> windows_;
    std::span<const Pass> passes_;
    Wanted wanted_;
    std::vector<Sums> sums_;  ///< by window
    size_t current_ = 0;      ///< window
    // Of the current pixel:
    PixelSums pixel_;
    PixelMoments moments_;
    PixelMattes mattes_;
    int added_ = 0;  ///< samples so far

    bool is_full(size_t window) const {
        const Window& its = windows_[window].window;
        return sums_[window].values.size() == static_cast<size_t>(its.width) * static_cast<size_t>(its.height);
    }
    void add_mattes(std::span<const MatteRecord> records) {
        for (const MatteRecord& record : records)
            for (size_t kind = 0; kind < kMatteKinds; ++kind) mattes_[kind].add(record.ids[kind], record.weight);
    }
    void finish_pixel() {
        const auto& [window, samples, taken] = windows_[current_];
        Sums& its = sums_[current_];
        const int number = static_cast<int>(its.values.size());
        its.values.push_back(pixel_.values(passes_, samples.count, wanted_.means));
        if (wanted_.moments) its.moments.push_back(std::exchange(moments_, {}));
        if (wanted_.mattes) its.mattes.push_back(std::exchange(mattes_, {}));
        if (wanted_.sums) {
            const int x = window.x + number % window.width, y = window.y + number / window.width;
            wanted_.sums->add(x, y, samples.count, pixel_);
            if (wanted_.mattes) wanted_.sums->add_mattes(x, y, samples.count, its.mattes.back());
        }
        pixel_.clear(passes_);
        added_ = 0;
    }
};

}  // namespace rayleaf
