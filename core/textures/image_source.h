// Where a texture's pixels come from: a file, the bytes of one, or an array. What a header tells is known at once;
// pixels are read later, by whichever thread has time.
#pragma once

#include "textures/picture.h"

#include <cstddef>
#include <functional>
#include <span>
#include <string>

namespace rayleaf {

struct ImageSource {
    Picture outline;  ///< without pixels
    /// The picture, which the outline describes; call it once. Throws InputError where it cannot be read.
    std::function<Picture()> read;
};

// `name` is the image's in messages. Each throws InputError where the header cannot be read, or says what no texture
// is.

/// `number`: which picture of a file that has several, like a movie.
ImageSource image_file(const std::string& name, const std::string& path, int number);
/// What a file holds, which is copied.
ImageSource packed_image(const std::string& name, std::span<const std::byte> bytes);
/// `channels` floats a pixel (1, 3 or 4), rows bottom to top, which are copied.
ImageSource image_pixels(std::span<const float> pixels, int width, int height, int channels);

}  // namespace rayleaf
