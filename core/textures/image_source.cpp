#include "textures/image_source.h"

#include "base/error.h"

#include <algorithm>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

namespace rayleaf {
namespace {

namespace oiio = OIIO;

/// Refuses files that hold no flat picture, or one so large that it cannot be meant: a header says any size.
void check_spec(const std::string& name, const std::string& source, const oiio::ImageSpec& spec) {
    const std::string size = std::to_string(spec.width) + " x " + std::to_string(spec.height) + " pixels, " +
                             std::to_string(spec.nchannels) + " channels";
    if (spec.deep || spec.depth > 1) throw InputError(name, source, "deep or a volume", "a flat picture");
    constexpr int kLargestSide = 1 << 17;
    constexpr double kMostPixels = 1u << 30;
    if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1 || spec.width > kLargestSide ||
        spec.height > kLargestSide || static_cast<double>(spec.width) * spec.height > kMostPixels)
        throw InputError(name, source, size, "at least 1 x 1 and at most 2^30 pixels, 2^17 a side");
}

/// Straight alpha is left as it is.
oiio::ImageSpec reading_hints() {
    oiio::ImageSpec hints;
    hints.attribute("oiio:UnassociatedAlpha", 1);
    return hints;
}

/// `source` is what a message calls it.
Picture outline_of(const std::string& name, const std::string& source, const oiio::ImageInput& input) {
    const oiio::ImageSpec& spec = input.spec();
    check_spec(name, source, spec);
    Picture outline;
    outline.width = spec.width;
    outline.height = spec.height;
    outline.channels = std::min(spec.nchannels, 4);
    outline.alpha = spec.get_int_attribute("oiio:UnassociatedAlpha") != 0 ? Alpha::Straight : Alpha::Associated;
    outline.precise = spec.format.basesize() > 2;
    return outline;
}

/// Into the picture. Bytes stay as they are: the library takes long to make numbers of them.
bool read_numbers(oiio::ImageInput& input, int number, Picture& picture) {
    if (input.spec().format != oiio::TypeDesc::UINT8) {
        picture.pixels.resize(picture.count());
        return input.read_image(number, 0, 0, picture.channels, oiio::TypeDesc::FLOAT, picture.pixels.data());
    }
    picture.bytes.resize(picture.count());
    return input.read_image(number, 0, 0, picture.channels, oiio::TypeDesc::UINT8, picture.bytes.data());
}

/// A file, or the bytes of one, that may be opened at any time.
class Encoded {
  public:
    virtual ~Encoded() = default;

    Picture outline(int number) const { return outline_of(name_, source_, *opened_at(number).input); }
    Picture read(int number) const {
        const Opened opened = opened_at(number);
        Picture picture = outline_of(name_, source_, *opened.input);
        if (!read_numbers(*opened.input, number, picture)) throw unreadable(opened.input->geterror());
        return picture;
    }

  protected:
    struct Opened {
        std::unique_ptr<oiio::Filesystem::IOProxy> bytes;  ///< that it reads; null: a file's
        std::unique_ptr<oiio::ImageInput> input;
    };
    Encoded(std::string name, std::string source) : name_(std::move(name)), source_(std::move(source)) {}
    virtual Opened open() const = 0;
    /// `reason`: the library's, which repeats itself from line to line.
    InputError unreadable(const std::string& reason) const {
        return {name_, source_, "not readable (" + reason.substr(0, reason.find('\n')) + ")", "a readable image"};
    }
    const std::string& name() const { return name_; }
    const std::string& source() const { return source_; }

  private:
    std::string name_, source_;

    Opened opened_at(int number) const {
        Opened opened = open();
        if (number != 0 && !opened.input->seek_subimage(number, 0))
            throw InputError(name_, source_, "no picture " + std::to_string(number + 1), "a picture that the file has");
        return opened;
    }
};

class EncodedFile final : public Encoded {
  public:
    EncodedFile(const std::string& name, std::string path)
        : Encoded(name, "image file '" + path + "'"), path_(std::move(path)) {}

  private:
    std::string path_;

    Opened open() const override {
        const oiio::ImageSpec hints = reading_hints();
        Opened opened{nullptr, oiio::ImageInput::open(path_, &hints)};
        if (!opened.input) throw unreadable(oiio::geterror());
        return opened;
    }
};

/// The name that a file of such bytes could have, from which the library knows the format: it tells by names alone.
const char* name_by_content(std::span<const std::byte> bytes) {
    struct Format {
        std::string_view begins, name;
    };
    using namespace std::string_view_literals;
    constexpr Format kFormats[] = {
        {"\x89PNG", "packed.png"}, {"\xff\xd8\xff", "packed.jpg"}, {"v/1\x01", "packed.exr"}, {"II*\0"sv, "packed.tif"},
        {"MM\0*"sv, "packed.tif"}, {"#?RADIANCE", "packed.hdr"},   {"RIFF", "packed.webp"},   {"BM", "packed.bmp"}};
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const auto* found = std::find_if(std::begin(kFormats), std::end(kFormats),
                                     [&](const Format& format) { return text.starts_with(format.begins); });
    return found == std::end(kFormats) ? nullptr : found->name.data();
}

class EncodedBytes final : public Encoded {
  public:
    EncodedBytes(const std::string& name, std::span<const std::byte> bytes)
        : Encoded(name, "packed image"), bytes_(bytes.begin(), bytes.end()) {}

  private:
    std::vector<std::byte> bytes_;

    Opened open() const override {
        const char* file = name_by_content(bytes_);
        if (!file)
            throw InputError(name(), source(), "of an unknown format",
                             "PNG, JPEG, OpenEXR, TIFF, Radiance, WebP or BMP");
        Opened opened{std::make_unique<oiio::Filesystem::IOMemReader>(bytes_.data(), bytes_.size()), nullptr};
        oiio::Filesystem::IOProxy* proxy = opened.bytes.get();
        oiio::ImageSpec hints = reading_hints();
        hints.attribute("oiio:ioproxy", oiio::TypeDesc::PTR,
                        static_cast<const void*>(&proxy));  // 2.4 reads it here alone
        opened.input = oiio::ImageInput::open(file, &hints, proxy);
        if (!opened.input) throw unreadable(oiio::geterror());
        return opened;
    }
};

ImageSource source_of(std::shared_ptr<const Encoded> encoded, int number) {
    Picture outline = encoded->outline(number);
    return {std::move(outline), [encoded = std::move(encoded), number] { return encoded->read(number); }};
}

}  // namespace

ImageSource image_file(const std::string& name, const std::string& path, int number) {
    return source_of(std::make_shared<EncodedFile>(name, path), number);
}

ImageSource packed_image(const std::string& name, std::span<const std::byte> bytes) {
    return source_of(std::make_shared<EncodedBytes>(name, bytes), 0);
}

ImageSource image_pixels(std::span<const float> pixels, int width, int height, int channels) {
    Picture outline;
    outline.width = width;
    outline.height = height;
    outline.channels = channels;
    const auto picture = std::make_shared<Picture>(outline);
    picture->pixels.reserve(pixels.size());
    const size_t row = outline.row();
    for (size_t y = static_cast<size_t>(height); y-- > 0;) {
        const std::span<const float> line = pixels.subspan(y * row, row);
        picture->pixels.insert(picture->pixels.end(), line.begin(), line.end());
    }
    return {std::move(outline), [picture] { return std::move(*picture); }};
}

}  // namespace rayleaf
