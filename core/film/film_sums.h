// Exact sums of each pixel's samples, so that parts rendered separately can be merged: other pixels, or other samples
// of the same pixels. Whether rendered at once or in parts, the bits are the same.
#pragma once

#include "film/pixel_sums.h"

#include <mutex>
#include <vector>

namespace rayleaf {

class FilmSums {
  public:
    FilmSums(int width, int height, std::vector<Pass> passes);

    int width() const { return width_; }
    int height() const { return height_; }
    const std::vector<Pass>& passes() const { return passes_; }
    const std::vector<Pass>& summed_passes() const { return summed_; }
    /// Null where no pass is one.
    const Mattes* mattes() const { return mattes_.get(); }
    bool has(Pass pass) const;
    size_t bytes() const;

    /// Adds samples of one pixel; `sums` is used up. Safe from any thread.
    void add(int x, int y, int samples, PixelSums& sums);

    /// Mattes of samples of one pixel. Safe from any thread.
    void add_mattes(int x, int y, int samples, const PixelMattes& mattes);

    /// The functions below give complete results once nothing is added any more.
    int least_samples() const;
    int most_samples() const;
    /// The terms of all sums of a pass, those of the same number together: each (row, column, channel), from below.
    const std::vector<std::vector<double>>& terms(Pass pass) const { return terms_[static_cast<size_t>(pass)]; }
    /// The picture of the samples that there are: (row, column, channel). The pass is one of `passes`.
    std::vector<float> pixels(Pass pass) const;

  private:
    int width_, height_;
    std::vector<Pass> passes_, summed_;
    std::vector<int> samples_;  ///< of each pixel
    std::array<std::vector<std::vector<double>>, kFirstMatte> terms_;
    std::unique_ptr<Mattes> mattes_;
    mutable std::mutex mutex_;

    size_t pixel(int x, int y) const {
        return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
    }
    void add_terms(size_t pixel, Pass pass, PixelSums& sums) const;
    void keep_terms(size_t pixel, Pass pass, PixelSums& sums);
    std::vector<float> means(Pass pass) const;
};

}  // namespace rayleaf
