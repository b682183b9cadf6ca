#include "base/error.h"
#include "film/film.h"

#include <OpenImageIO/imageio.h>

namespace rayleaf {
namespace {

/// Passes interleaved into the rows of a file, top row first.
std::vector<float> interleaved(const Film& film, size_t channels) {
    const auto width = static_cast<size_t>(film.width()), height = static_cast<size_t>(film.height());
    std::vector<float> rows(width * height * channels);
    size_t first = 0;
    for (const Pass pass : film.passes()) {
        const std::vector<float> pixels = film.pixels(pass);
        const size_t own = info(pass).channels.size();
        for (size_t y = 0; y < height; ++y)
            for (size_t x = 0; x < width; ++x)
                for (size_t c = 0; c < own; ++c)
                    rows[((height - 1 - y) * width + x) * channels + first + c] = pixels[(y * width + x) * own + c];
        first += own;
    }
    return rows;
}

}  // namespace

void write_exr(const Film& film, const std::string& path, const std::map<std::string, std::string>& attributes) {
    OIIO::ImageSpec spec(film.width(), film.height(), 0, OIIO::TypeFloat);
    for (const Pass pass : film.passes())
        for (const char channel : info(pass).channels) {
            spec.channelnames.push_back(std::string(info(pass).name) + "." + channel);
            ++spec.nchannels;
        }
    spec.attribute("compression", "zip");
    for (const auto& [name, text] : attributes) spec.attribute(name, text);
    const std::vector<float> rows = interleaved(film, static_cast<size_t>(spec.nchannels));
    const std::unique_ptr<OIIO::ImageOutput> file = OIIO::ImageOutput::create(path);
    if (!file || !file->open(path, spec) || !file->write_image(OIIO::TypeFloat, rows.data()) || !file->close())
        throw InputError("film", "path", "'" + path + "' (" + (file ? file->geterror() : OIIO::geterror()) + ")",
                         "a file ending in .exr that can be written");
}

}  // namespace rayleaf
