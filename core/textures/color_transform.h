// Colours of images by OpenColorIO: from a space that a configuration names to the scene's linear light.
#pragma once

#include "base/content_hash.h"

#include <cstddef>
#include <memory>
#include <string>

namespace rayleaf {

class ColorTransform {
  public:
    /// From `space` of the configuration file at `config` to its role scene_linear. Throws InputError, which names
    /// `image`, where there is no such file or space.
    ColorTransform(const std::string& image, const std::string& config, const std::string& space);
    ~ColorTransform();
    ColorTransform(const ColorTransform&) = delete;
    ColorTransform& operator=(const ColorTransform&) = delete;

    /// Of `count` colours of three channels one after the other, not multiplied by alpha. Thread-safe.
    void apply(float* colors, size_t count) const;
    void add_to(ContentHasher& hasher) const;

  private:
    struct Processor;
    std::unique_ptr<const Processor> processor_;
    ContentHash key_{};
};

}  // namespace rayleaf
