// The film: the passes of the rendered part of the picture, filled tile by tile.
//
// Rows run bottom to top, as Blender wants them. Tiles do not share pixels, so their order does not matter.
#pragma once

#include "film/mattes.h"
#include "film/pixel_sums.h"
#include "film/window.h"

#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace rayleaf {

class Film {
  public:
    Film(int width, int height, std::vector<Pass> passes);

    int width() const { return width_; }
    int height() const { return height_; }
    const std::vector<Pass>& passes() const { return passes_; }
    /// Those that hold sums of samples: all but mattes.
    const std::vector<Pass>& summed_passes() const { return summed_; }
    bool has_mattes() const { return mattes_ != nullptr; }

    /// Stores a tile of finished pixels (row by row, x from left, y from below).
    void put(const Window& tile, std::span<const PixelValues> values);
    /// Moves pixels by a share of the way to new values, like a mean that takes in more samples; passes that cannot be
    /// averaged keep their values.
    void refine(const Window& tile, std::span<const PixelValues> values, float share);
    /// Adds so many samples of each pixel of a tile.
    void add_mattes(const Window& tile, int samples, std::span<const PixelMattes> mattes);
    /// From now on what is put and refined are plain means, of which more samples follow. What they come to is made of
    /// them whenever a pass is read: quotients and limits of means, not means of those.
    void hold_means();
    bool holds_means() const { return holds_means_; }
    /// Stores values that each fill a block of pixels, clipped at the right and upper border. The tile is in units of
    /// blocks.
    void put_blocks(const Window& tile, std::span<const PixelValues> values, int size);
    /// Copies a pass, channels interleaved; empty if the film does not have it. Safe while tiles arrive.
    std::vector<float> pixels(Pass pass) const;
    bool has(Pass pass) const;
    size_t bytes() const;

  private:
    int width_, height_;
    std::vector<Pass> passes_, summed_;
    std::array<std::vector<float>, kFirstMatte> data_;
    std::unique_ptr<Mattes> mattes_;  ///< null: none
    bool holds_means_ = false;
    mutable std::mutex mutex_;

    /// `update(old, value)` for each channel of a rectangle's pixels.
    template <typename Update>
    void update(Pass pass, const Window& tile, std::span<const PixelValues> values, const Update& update);
    const std::vector<float>& data(Pass pass) const { return data_[static_cast<size_t>(pass)]; }
    /// As the pass's rule has it.
    std::vector<float> finished(Pass pass) const;
    std::vector<float> caught_share() const;
    float* at(Pass pass, int x, int y) {
        const size_t pixel = static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
        return &data_[static_cast<size_t>(pass)][pixel * info(pass).channels.size()];
    }
};

/// Writes all passes as one multilayer EXR, channels named `Pass.channel`, 32-bit floats.
/// `attributes` go into the file's header. Throws InputError that names the path.
void write_exr(const Film& film, const std::string& path, const std::map<std::string, std::string>& attributes = {});
/// Writes the combined pass as a binary PPM: 8 bits a channel, sRGB, clipped at white, no alpha.
/// Throws InputError that names the path, or the pass if the film has none.
void write_ppm(const Film& film, const std::string& path);

}  // namespace rayleaf
