// Image files of any bytes under the names of several formats, such bytes packed, and arrays of pixels: refused with a
// message, or a texture whose lookups are finite.
#include "fuzz_input.h"
#include "textures/texture_store.h"

#include <filesystem>
#include <fstream>

#include <unistd.h>

using namespace rayleaf;

namespace {

/// The readers are other people's and as good as they are; what is tried here is what is made of their answers.
constexpr const char* kEndings[] = {"hdr", "bmp", "tga", "ppm", "png", "sgi", "pgm", "rgbe"};

/// A folder of this process.
const std::filesystem::path& folder() {
    static const std::filesystem::path made = [] {
        const auto path = std::filesystem::temp_directory_path() / ("rayleaf_fuzz_" + std::to_string(getpid()));
        std::filesystem::create_directories(path);
        return path;
    }();
    return made;
}

void look_up(const TextureStore& store, TextureId id, fuzz::Bytes& bytes) {
    for (int i = 0; i < 6; ++i) {
        const std::vector<float> place = bytes.floats(6);
        const auto extension = static_cast<TextureExtension>(bytes.count(3));
        const TextureReading reading{static_cast<TextureInterpolation>(bytes.count(2)), bytes.flag()};
        const Vec4f value =
            store.lookup(id, {place[0], place[1]}, {place[2], place[3]}, {place[4], place[5]}, extension, reading);
        for (int c = 0; c < 4; ++c) fuzz::require(std::isfinite(value[c]));
    }
}

TextureId add_pixels(TextureStore& store, fuzz::Bytes& bytes, const ImageColors& colors) {
    const int width = bytes.count(9), height = bytes.count(9), channels = bytes.count(5);
    const std::vector<float> pixels = bytes.ill_fitting_floats(static_cast<size_t>(width * height * channels));
    return store.add_pixels("drawn", pixels, width, height, channels, colors);
}

TextureId add_packed(TextureStore& store, fuzz::Bytes& bytes, const ImageColors& colors) {
    return store.add_packed("drawn", std::as_bytes(bytes.rest()), colors);
}

TextureId add_file(TextureStore& store, fuzz::Bytes& bytes, const ImageColors& colors) {
    const auto path = folder() / (std::string("drawn.") + kEndings[bytes.byte() % std::size(kEndings)]);
    const std::span<const uint8_t> content = bytes.rest();
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(content.data()), static_cast<std::streamsize>(content.size()));
    return store.add_file("drawn", path.string(), colors);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    fuzz::Bytes bytes(data, size);
    TextureStore store(size_t{16} << 20);
    const auto space = static_cast<ColorSpace>(bytes.count(2));
    const ImageColors colors(space, static_cast<ImageAlpha>(bytes.count(3)));
    constexpr decltype(&add_file) kAdders[] = {add_file, add_packed, add_pixels};
    fuzz::refusing([&] {
        const TextureId id = kAdders[bytes.count(2)](store, bytes, colors);
        fuzz::Bytes places(data, size);
        look_up(store, id, places);
        look_up(store, bytes.byte(), places);  // mostly another than there is
    });
    return 0;
}
