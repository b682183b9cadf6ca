// Every image is converted once, when it is added: to linear light with alpha multiplied in, so that filtering is
// right, as a tiled and mip-mapped OpenEXR file in a temporary folder that goes with the store. From there
// OpenImageIO's texture system pages tiles in and out within the memory limit.
#include "textures/texture_store.h"

#include "base/append_list.h"
#include "base/error.h"

#include <filesystem>
#include <vector>

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/texture.h>
#include <unistd.h>

namespace rayleaf {
namespace {

namespace oiio = OIIO;

constexpr int kTile = 64;  ///< pixels; what OpenImageIO's own tool makes
constexpr int kLargestAnisotropy = 16;
constexpr float kLargestHalf = 65504.0f;

/// Decoding of sRGB (IEC 61966-2-1).
float linear_from_srgb(float x) {
    if (x <= 0.04045f) return x / 12.92f;
    return std::pow((x + 0.055f) / 1.055f, 2.4f);
}

/// Whether the pixels that come in have been multiplied by their alpha.
enum class Alpha : uint8_t { Straight, Associated };

/// Pixels in memory, rows top to bottom, straight or associated as they came.
struct Picture {
    std::vector<float> pixels;
    int width = 0, height = 0, channels = 0;
    Alpha alpha = Alpha::Straight;
    bool precise = false;  ///< wants more than half floats

    int alpha_channel() const { return channels == 4 ? 3 : -1; }
};

/// To linear light with associated alpha. Data images keep their channels as they are.
void linearize(Picture& picture, ColorSpace space) {
    if (space == ColorSpace::NonColor) return;
    const int alpha_channel = picture.alpha_channel();
    const int colors = alpha_channel >= 0 ? alpha_channel : picture.channels;
    const size_t channels = static_cast<size_t>(picture.channels);
    for (size_t i = 0; i < picture.pixels.size(); i += channels) {
        float* pixel = &picture.pixels[i];
        const float alpha = alpha_channel >= 0 ? pixel[alpha_channel] : 1.0f;
        for (int c = 0; c < colors; ++c) {
            float x = pixel[c];
            if (picture.alpha == Alpha::Associated && space == ColorSpace::Srgb && alpha > 0.0f)
                x = linear_from_srgb(x / alpha) * alpha;
            else if (space == ColorSpace::Srgb)
                x = linear_from_srgb(x);
            if (picture.alpha == Alpha::Straight) x *= alpha;
            pixel[c] = x;
        }
    }
}

/// Values a half float cannot hold ask for floats; infinities and NaN, which some panoramas contain, become numbers.
void make_finite(Picture& picture) {
    for (float& x : picture.pixels) {
        if (!std::isfinite(x)) x = x > 0.0f ? kLargestHalf : 0.0f;
        if (std::abs(x) > kLargestHalf) picture.precise = true;
    }
}

/// One to four channels: grey, grey and alpha become what lookups know: 1, 3 or 4.
void normalize_channels(Picture& picture) {
    const int from = picture.channels, to = from == 2 ? 4 : std::min(from, 4);
    if (from == to) return;
    const size_t count = static_cast<size_t>(picture.width) * static_cast<size_t>(picture.height);
    std::vector<float> pixels(count * static_cast<size_t>(to));
    for (size_t i = 0; i < count; ++i)
        for (int c = 0; c < to; ++c) {
            const int source = from == 2 ? (c == 3 ? 1 : 0) : c;
            pixels[i * static_cast<size_t>(to) + static_cast<size_t>(c)] =
                picture.pixels[i * static_cast<size_t>(from) + static_cast<size_t>(source)];
        }
    picture.pixels = std::move(pixels);
    picture.channels = to;
}

/// A folder of its own under the system's temporary one, removed with the object.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "rayleaf_textures_XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr)
            throw InputError("textures", "temporary folder", "'" + name + "', not writable", "a folder for textures");
        path_ = name;
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    std::string file(size_t number) const { return (path_ / (std::to_string(number) + ".exr")).string(); }

  private:
    std::filesystem::path path_;
};

/// The texture system of all stores, apart from any that the host program has. It is made by the first store and never
/// destroyed: OpenImageIO 2.4 frees part of it with another alignment than it was allocated with, which corrupts the
/// heap under jemalloc, the allocator that Blender runs with. Stores give their tiles back one by one instead.
oiio::TextureSystem& texture_system() {
    // A plain pointer until OpenImageIO 2.5, a shared one since 3.0: behind a reference neither is ever destroyed.
    static const auto& system = *new auto(oiio::TextureSystem::create(false));
    return *system;
}

/// Tiles read from files since the process began.
size_t tiles_read() {
    int tiles = 0;
    texture_system().getattribute("stat:tiles_created", oiio::TypeDesc::INT, &tiles);
    return static_cast<size_t>(std::max(tiles, 0));
}

/// What a lookup needs to know of a texture.
struct Texture {
    oiio::TextureSystem::TextureHandle* handle = nullptr;
    int channels = 0;
    bool associated = false;  ///< colours are multiplied by alpha and must be divided again
};

oiio::TextureOpt::Wrap wrap(TextureExtension extension, bool along_u) {
    switch (extension) {
        case TextureExtension::Repeat:
            return oiio::TextureOpt::WrapPeriodic;
        case TextureExtension::Clip:
            return oiio::TextureOpt::WrapBlack;
        case TextureExtension::Mirror:
            return oiio::TextureOpt::WrapMirror;
        case TextureExtension::Panorama:
            return along_u ? oiio::TextureOpt::WrapPeriodic : oiio::TextureOpt::WrapClamp;
        default:
            return oiio::TextureOpt::WrapClamp;
    }
}

oiio::TextureOpt options(TextureExtension extension, TextureInterpolation interpolation) {
    oiio::TextureOpt result;
    result.swrap = wrap(extension, true);
    result.twrap = wrap(extension, false);
    result.anisotropic = kLargestAnisotropy;
    result.fill = 0.0f;
    switch (interpolation) {
        case TextureInterpolation::Closest:
            result.interpmode = oiio::TextureOpt::InterpClosest;
            result.mipmode = oiio::TextureOpt::MipModeNoMIP;
            break;
        case TextureInterpolation::Linear:
            result.interpmode = oiio::TextureOpt::InterpBilinear;
            result.mipmode = oiio::TextureOpt::MipModeAniso;
            break;
        case TextureInterpolation::Cubic:
            result.interpmode = oiio::TextureOpt::InterpBicubic;
            result.mipmode = oiio::TextureOpt::MipModeAniso;
            break;
    }
    return result;
}

/// Refuses files that hold no flat picture, or one so large that it cannot be meant: a header says any size.
void check_spec(const std::string& name, const std::string& path, const oiio::ImageSpec& spec) {
    const std::string argument = "image file '" + path + "'";
    const std::string size = std::to_string(spec.width) + " x " + std::to_string(spec.height) + " pixels, " +
                             std::to_string(spec.nchannels) + " channels";
    if (spec.deep || spec.depth > 1) throw InputError(name, argument, "deep or a volume", "a flat picture");
    constexpr int kLargestSide = 1 << 17;
    constexpr double kMostPixels = 1u << 30;
    if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1 || spec.width > kLargestSide ||
        spec.height > kLargestSide || static_cast<double>(spec.width) * spec.height > kMostPixels)
        throw InputError(name, argument, size, "at least 1 x 1 and at most 2^30 pixels, 2^17 a side");
}

float finite(float x) {
    return std::isfinite(x) ? x : 0.0f;
}
Vec2f finite(const Vec2f& v) {
    return {finite(v.x), finite(v.y)};
}

}  // namespace

struct TextureStore::Implementation {
    TemporaryFolder folder;
    AppendList<Texture> textures;
    size_t tiles_before = tiles_read();  ///< by stores before this one

    explicit Implementation(size_t memory_limit) {
        constexpr float kMegabyte = 1 << 20;
        texture_system().attribute("max_memory_MB", static_cast<float>(memory_limit) / kMegabyte);
    }
    ~Implementation() {
        for (size_t i = 0; i < textures.size(); ++i) texture_system().invalidate(oiio::ustring(folder.file(i)));
    }
    Implementation(const Implementation&) = delete;
    Implementation& operator=(const Implementation&) = delete;

    TextureId add(const std::string& name, Picture picture, ColorSpace space) {
        normalize_channels(picture);
        linearize(picture, space);
        make_finite(picture);
        const std::string file = folder.file(textures.size());
        oiio::ImageSpec spec(picture.width, picture.height, picture.channels, oiio::TypeDesc::FLOAT);
        const oiio::ImageBuf buffer(spec, picture.pixels.data());
        oiio::ImageSpec config;
        config.tile_width = config.tile_height = kTile;
        config.format = picture.precise ? oiio::TypeDesc::FLOAT : oiio::TypeDesc::HALF;
        config.attribute("maketx:fileformatname", "openexr");
        config.attribute("compression", "zip");
        if (!oiio::ImageBufAlgo::make_texture(oiio::ImageBufAlgo::MakeTxTexture, buffer, file, config))
            throw InputError(name, "image", "not convertible (" + oiio::geterror() + ")",
                             "a texture in '" + file + "'");
        Texture texture;
        texture.handle = texture_system().get_texture_handle(oiio::ustring(file));
        texture.channels = picture.channels;
        texture.associated = picture.alpha_channel() >= 0 && space != ColorSpace::NonColor;
        if (texture.handle == nullptr || !texture_system().good(texture.handle))
            throw InputError(name, "image", "not readable after conversion (" + texture_system().geterror() + ")",
                             "a texture");
        textures.append(texture);
        return static_cast<TextureId>(textures.size()) - 1;
    }
};

TextureStore::TextureStore(size_t memory_limit) : implementation_(std::make_unique<Implementation>(memory_limit)) {}
TextureStore::~TextureStore() = default;

TextureId TextureStore::add_file(const std::string& name, const std::string& path, ColorSpace space) {
    oiio::ImageSpec hints;
    hints.attribute("oiio:UnassociatedAlpha", 1);  // leave straight alpha as the file has it
    const std::unique_ptr<oiio::ImageInput> input = oiio::ImageInput::open(path, &hints);
    if (!input) throw InputError(name, "image file '" + path + "'", oiio::geterror(), "a readable image");
    const oiio::ImageSpec& spec = input->spec();
    check_spec(name, path, spec);
    Picture picture;
    picture.width = spec.width;
    picture.height = spec.height;
    picture.channels = std::min(spec.nchannels, 4);
    picture.alpha = spec.get_int_attribute("oiio:UnassociatedAlpha") != 0 ? Alpha::Straight : Alpha::Associated;
    picture.precise = spec.format.basesize() > 2;
    picture.pixels.resize(static_cast<size_t>(spec.width) * static_cast<size_t>(spec.height) *
                          static_cast<size_t>(picture.channels));
    if (!input->read_image(0, 0, 0, picture.channels, oiio::TypeDesc::FLOAT, picture.pixels.data()))
        throw InputError(name, "image file '" + path + "'", input->geterror(), "a readable image");
    return implementation_->add(name, std::move(picture), space);
}

TextureId TextureStore::add_pixels(const std::string& name, std::span<const float> pixels, int width, int height,
                                   int channels, ColorSpace space) {
    if (width <= 0 || height <= 0)
        throw InputError(name, "image size", std::to_string(width) + " x " + std::to_string(height), "at least 1 x 1");
    if (channels != 1 && channels != 3 && channels != 4)
        throw InputError(name, "image channels", std::to_string(channels), "1, 3 or 4");
    const size_t row = static_cast<size_t>(width) * static_cast<size_t>(channels);
    if (pixels.size() != row * static_cast<size_t>(height))
        throw InputError(name, "number of pixel values", std::to_string(pixels.size()),
                         std::to_string(row * static_cast<size_t>(height)));
    Picture picture;
    picture.width = width;
    picture.height = height;
    picture.channels = channels;
    picture.pixels.reserve(pixels.size());
    for (size_t y = static_cast<size_t>(height); y-- > 0;) {
        const std::span<const float> line = pixels.subspan(y * row, row);
        picture.pixels.insert(picture.pixels.end(), line.begin(), line.end());
    }
    return implementation_->add(name, std::move(picture), space);
}

Vec4f TextureStore::lookup(TextureId id, const Vec2f& uv, const Vec2f& duv_dx, const Vec2f& duv_dy,
                           TextureExtension extension, TextureInterpolation interpolation) const {
    if (id < 0 || static_cast<size_t>(id) >= implementation_->textures.size()) return Vec4f(0.0f, 0.0f, 0.0f, 0.0f);
    const Texture& texture = implementation_->textures[static_cast<size_t>(id)];
    const Vec2f p = finite(uv), dx = finite(duv_dx), dy = finite(duv_dy);
    oiio::TextureOpt lookup_options = options(extension, interpolation);
    float value[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    // OpenImageIO's t runs down the picture.
    texture_system().texture(texture.handle, nullptr, lookup_options, p.x, 1.0f - p.y, dx.x, -dx.y, dy.x, -dy.y,
                             texture.channels, value);
    if (texture.channels < 4) {
        const bool inside = p.x >= 0.0f && p.x <= 1.0f && p.y >= 0.0f && p.y <= 1.0f;
        value[3] = extension != TextureExtension::Clip || inside ? 1.0f : 0.0f;
    }
    if (texture.channels == 1) value[1] = value[2] = value[0];
    if (texture.associated && value[3] > 0.0f)
        for (int c = 0; c < 3; ++c) value[c] /= value[3];
    return Vec4f(finite(value[0]), finite(value[1]), finite(value[2]), finite(value[3]));
}

TextureStore::Statistics TextureStore::statistics() const {
    long long bytes = 0;
    texture_system().getattribute("stat:cache_memory_used", oiio::TypeDesc::INT64, &bytes);
    return {implementation_->textures.size(), static_cast<size_t>(std::max(bytes, 0LL)),
            tiles_read() - implementation_->tiles_before};
}

}  // namespace rayleaf
