// The film: the passes of the rendered part of the picture, filled tile by tile.
//
// Rows run bottom to top, as Blender wants them. Tiles do not share pixels, so their order does not matter.
#pragma once

#include "film/pass.h"
#include "film/pixel.h"

#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace rayleaf {

/// How the samples of a pixel become its value.
enum class PassRule {
    Mean,         ///< of all samples
    FirstSample,  ///< indices and places, which mean nothing when averaged
    Divided       ///< mean, divided by the mean of a colour pass: light without the surface's colour
};

/// The rule of a pass, and for Divided the colour pass it is divided by.
struct PassRuleInfo {
    PassRule rule = PassRule::Mean;
    Pass color = Pass::combined;
};
PassRuleInfo rule(Pass pass);

/// Passes to compute for a list of wanted ones: each once, with the colours that Divided ones need.
std::vector<Pass> computed_passes(const std::vector<Pass>& wanted);

/// Sums of one pixel's samples.
class PixelSums {
  public:
    PixelSums() { sums_.fill(Vec4d(0.0)); }
    void add(const PixelSample& sample, std::span<const Pass> passes);
    Vec4f value(Pass pass) const;

  private:
    std::array<Vec4d, kPassCount> sums_;
    int count_ = 0;
};

class Film {
  public:
    Film(int width, int height, std::vector<Pass> passes);

    int width() const { return width_; }
    int height() const { return height_; }
    const std::vector<Pass>& passes() const { return passes_; }

    /// Stores a tile of finished pixels (`sums` row by row, x from left, y from below).
    void put(int x, int y, int width, int height, std::span<const PixelSums> sums);
    /// Copies a pass, channels interleaved; empty if the film has none of it. Safe while tiles arrive.
    std::vector<float> pixels(Pass pass) const;
    bool has(Pass pass) const { return !data_[static_cast<size_t>(pass)].empty(); }
    size_t bytes() const;

  private:
    int width_, height_;
    std::vector<Pass> passes_;
    std::array<std::vector<float>, kPassCount> data_;
    mutable std::mutex mutex_;
};

/// Writes all passes as one multilayer EXR, channels named `Pass.channel`, 32-bit floats.
/// Throws InputError that names the path.
void write_exr(const Film& film, const std::string& path);
/// Writes the combined pass as a binary PPM: 8 bits a channel, sRGB, what is brighter than white cut off, no alpha.
/// Throws InputError that names the path, or the pass if the film has none.
void write_ppm(const Film& film, const std::string& path);

}  // namespace rayleaf
