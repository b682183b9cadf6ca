#include "base/error.h"
#include "film/film.h"

#include <algorithm>
#include <cmath>

#include <OpenImageIO/imageio.h>

namespace rayleaf {
namespace {

constexpr size_t kChannels = 3;

/// IEC 61966-2-1, from linear light in [0,1]; NaN is black.
uint8_t srgb_byte(float linear) {
    const float x = linear > 0.0f ? std::min(linear, 1.0f) : 0.0f;
    const float encoded = x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f;
    return static_cast<uint8_t>(std::lround(255.0f * encoded));
}

/// The combined pass, top row first.
std::vector<uint8_t> bytes_of(const Film& film) {
    const std::vector<float> pixels = film.pixels(Pass::combined);
    const auto width = static_cast<size_t>(film.width()), height = static_cast<size_t>(film.height());
    const size_t own = info(Pass::combined).channels.size();
    std::vector<uint8_t> bytes(width * height * kChannels);
    for (size_t y = 0; y < height; ++y)
        for (size_t x = 0; x < width; ++x)
            for (size_t c = 0; c < kChannels; ++c)
                bytes[((height - 1 - y) * width + x) * kChannels + c] = srgb_byte(pixels[(y * width + x) * own + c]);
    return bytes;
}

}  // namespace

void write_ppm(const Film& film, const std::string& path) {
    if (!film.has(Pass::combined)) throw InputError("film", "passes", "without Combined", "Combined among them");
    const OIIO::ImageSpec spec(film.width(), film.height(), kChannels, OIIO::TypeUInt8);
    const std::vector<uint8_t> bytes = bytes_of(film);
    const bool is_ppm = path.ends_with(".ppm");
    const std::unique_ptr<OIIO::ImageOutput> file = is_ppm ? OIIO::ImageOutput::create(path) : nullptr;
    if (!file || !file->open(path, spec) || !file->write_image(OIIO::TypeUInt8, bytes.data()) || !file->close())
        throw InputError("film", "path", "'" + path + "'" + (file ? " (" + file->geterror() + ")" : ""),
                         "a file ending in .ppm that can be written");
}

}  // namespace rayleaf
