#include "textures/color_transform.h"

#include "base/error.h"

#include <fstream>
#include <iterator>
#include <vector>

#include <OpenImageIO/color.h>

namespace rayleaf {

struct ColorTransform::Processor {
    OIIO::ColorProcessorHandle handle;
};

ColorTransform::ColorTransform(const std::string& image, const std::string& config, const std::string& space) {
    const auto fail = [&](const std::string& found) {
        throw InputError(image, "colour space '" + space + "' by " + config, found,
                         "a colour space of an OpenColorIO configuration");
    };
    std::ifstream file(config, std::ios::binary);
    const std::vector<char> text{std::istreambuf_iterator<char>(file), {}};
    if (text.empty()) fail("unreadable");
    if (!OIIO::ColorConfig::supportsOpenColorIO()) fail("not known to this OpenImageIO, which lacks OpenColorIO");
    OIIO::ColorConfig parsed(config);
    if (parsed.has_error()) fail(parsed.geterror());
    const OIIO::ColorProcessorHandle handle = parsed.createColorProcessor(space, "scene_linear");
    if (!handle) fail(parsed.geterror());
    processor_ = std::make_unique<const Processor>(Processor{handle});
    ContentHasher hasher;
    hasher.add(text);
    hasher.add(std::vector<char>(config.begin(), config.end()));  // tables lie beside it
    hasher.add(std::vector<char>(space.begin(), space.end()));
    key_ = hasher.value();
}

ColorTransform::~ColorTransform() = default;

void ColorTransform::apply(float* colors, size_t count) const {
    constexpr OIIO::stride_t kChannel = sizeof(float), kColor = 3 * sizeof(float);
    const auto width = static_cast<int>(count);
    processor_->handle->apply(colors, width, 1, 3, kChannel, kColor, kColor * width);
}

void ColorTransform::add_to(ContentHasher& hasher) const {
    for (const uint64_t word : key_) hasher.add(word);
}

}  // namespace rayleaf
