// Every image is converted after it is added, unless it has been before: to linear light with alpha multiplied in, so
// that filtering is right. From the converted files OpenImageIO's texture system pages tiles in and out within the
// memory limit.
#include "textures/texture_store.h"

#include "base/append_list.h"
#include "base/error.h"
#include "textures/converted_textures.h"
#include "textures/image_source.h"
#include "textures/texture_system.h"

#include <algorithm>
#include <atomic>
#include <optional>
#include <vector>

#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>
#include <sys/stat.h>

namespace rayleaf {
namespace {

namespace oiio = OIIO;

/// A long footprint is filtered as if it were round and as wide as it is narrow. The rest is left to the samples of a
/// pixel, which lie all over it (Pharr, Wronski, Salvi, Fajardo 2024, "Filtering After Shading With Stochastic Texture
/// Filtering"): probes along a footprint cost most where surfaces are seen at grazing angles, and leave the same noise.
constexpr int kLargestAnisotropy = 1;
/// An image of so many bytes is converted by all threads together, when the scene is committed.
constexpr size_t kLarge = size_t{64} << 20;
/// Smaller images that wait to be converted hold at most so many bytes together; another is converted at once.
constexpr size_t kMostWaiting = size_t{256} << 20;

/// What stands for an image that cannot be read, as in Cycles: pink.
const Vec4f kUnreadable(1.0f, 0.0f, 1.0f, 1.0f);

/// Tiles read from files since the process began.
size_t tiles_read() {
    int tiles = 0;
    texture_system().getattribute("stat:tiles_created", oiio::TypeDesc::INT, &tiles);
    return static_cast<size_t>(std::max(tiles, 0));
}

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
    result.conservative_filter = false;  // no wider than that
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

Vec2f finite_coordinates(const Vec2f& v) {
    return {finite_or_zero(v.x), finite_or_zero(v.y)};
}

/// Coordinates that look up the same. Beyond a picture that does not repeat it is the same everywhere; OpenImageIO
/// counts pixels in integers, which end.
Vec2f near_coordinates(const Vec2f& v, TextureExtension extension) {
    constexpr float kBefore = -16.0f, kBehind = 17.0f;
    const auto near = [=](float x) { return std::clamp(x, kBefore, kBehind); };
    if (extension == TextureExtension::Panorama) return {v.x, near(v.y)};
    if (extension != TextureExtension::Extend && extension != TextureExtension::Clip) return v;
    return {near(v.x), near(v.y)};
}

/// The share of a footprint, or of the pixels that are interpolated, that lies in the picture along one axis.
float covered_share(float x, float footprint, int pixels) {
    const float half = std::max(0.5f / static_cast<float>(pixels), 0.5f * footprint);
    const float below = (x + half) / (2.0f * half), above = (1.0f - x + half) / (2.0f * half);
    return std::clamp(below, 0.0f, 1.0f) * std::clamp(above, 0.0f, 1.0f);
}
float covered_share(const ConvertedTexture& texture, const Vec2f& p, const Vec2f& dx, const Vec2f& dy,
                    TextureInterpolation interpolation) {
    if (interpolation == TextureInterpolation::Closest)
        return p.x >= 0.0f && p.x <= 1.0f && p.y >= 0.0f && p.y <= 1.0f ? 1.0f : 0.0f;
    return covered_share(p.x, std::abs(dx.x) + std::abs(dy.x), texture.width()) *
           covered_share(p.y, std::abs(dx.y) + std::abs(dy.y), texture.height());
}

/// From linear light with associated alpha. Multiplied, that stays as it is where nothing was encoded: a flame may
/// shine where its alpha is 0.
void read_associated(float (&value)[4], bool is_multiplied, bool is_encoded) {
    const float alpha = value[3];
    if (!(alpha > 0.0f) || (is_multiplied && (!is_encoded || alpha == 1.0f))) return;
    for (int c = 0; c < 3; ++c) {
        const float straight = value[c] / alpha;
        value[c] = is_multiplied ? decoded_srgb(encoded_srgb(straight) * alpha) : straight;
    }
}

}  // namespace

struct TextureStore::Implementation {
    std::shared_ptr<ConvertedTextures> converted;
    AppendList<std::shared_ptr<const ConvertedTexture>> textures;
    size_t tiles_before = tiles_read();  ///< by stores before this one
    /// Its own, with a place for who waits: tasks of another thread's arena are run by oneTBB's workers alone, of which
    /// there are none where one thread is allowed, and the wait would have no end.
    tbb::task_arena arena;
    tbb::task_group conversions;
    CancelToken gone;                ///< nobody waits for conversions any more
    std::atomic<size_t> waiting{0};  ///< bytes of pictures

    Implementation(size_t memory_limit, std::shared_ptr<ConvertedTextures> kept)
        : converted(kept ? std::move(kept) : std::make_shared<ConvertedTextures>()) {
        constexpr float kMegabyte = 1 << 20;
        texture_system().attribute("max_memory_MB", static_cast<float>(memory_limit) / kMegabyte);
        converted->next_user();
    }
    ~Implementation() {
        gone.cancel();
        arena.execute([this] { conversions.wait(); });
    }

    /// The texture of that key; `source` tells where its pixels come from, if they are wanted.
    template <typename GetSource>
    TextureId add(const std::string& name, const ImageColors& colors, const ContentHash& key, const GetSource& source) {
        std::shared_ptr<const ConvertedTexture> texture = converted->find(key);
        if (!texture || texture->has_failed()) {
            texture = std::make_shared<const ConvertedTexture>(name, source(), colors, key);
            converted->keep(key, texture);
            begin(texture);
        }
        textures.append(std::move(texture));
        return static_cast<TextureId>(textures.size()) - 1;
    }

    /// Other threads read and convert it. A large one they read alone.
    void begin(const std::shared_ptr<const ConvertedTexture>& texture) {
        const size_t bytes = texture->picture_bytes();
        if (bytes >= kLarge) return run([texture] { texture->read(); });
        if (waiting.fetch_add(bytes) + bytes > kMostWaiting) {
            waiting -= bytes;
            return texture->convert();
        }
        run([this, texture, bytes] {
            try {
                texture->convert(gone);
            } catch (const Cancelled&) {  // nobody waits for it
            }
            waiting -= bytes;
        });
    }

    template <typename Work>
    void run(Work work) {
        const auto task = [work = std::move(work)] {
            try {
                work();
            } catch (const std::exception&) {  // who waits for it tries again, and throws what it meets
            }
        };
        arena.execute([&] { conversions.run(task); });
    }
};

void ImageColors::add_to(ContentHasher& hasher) const {
    hasher.add(static_cast<int>(space));
    hasher.add(static_cast<int>(alpha));
    if (transform) transform->add_to(hasher);
}

TextureStore::TextureStore(size_t memory_limit, std::shared_ptr<ConvertedTextures> converted)
    : implementation_(std::make_unique<Implementation>(memory_limit, std::move(converted))) {}
TextureStore::~TextureStore() = default;

namespace {

/// Who reads a file again knows it by its place, size and time.
ContentHash key_of_file(const std::string& path, const ImageColors& colors, int picture) {
    ContentHasher hasher;
    hasher.add(picture);
    colors.add_to(hasher);
    hasher.add(std::vector<char>(path.begin(), path.end()));
    struct stat status {};
    if (stat(path.c_str(), &status) != 0) return hasher.value();  // reading it will say what is wrong
    for (const auto number : {status.st_dev, status.st_ino, static_cast<ino_t>(status.st_size),
                              static_cast<ino_t>(status.st_mtim.tv_sec), static_cast<ino_t>(status.st_mtim.tv_nsec)})
        hasher.add(static_cast<uint64_t>(number));
    return hasher.value();
}

}  // namespace

TextureId TextureStore::add_file(const std::string& name, const std::string& path, const ImageColors& colors,
                                 int picture) {
    return implementation_->add(name, colors, key_of_file(path, colors, picture),
                                [&] { return image_file(name, path, picture); });
}

TextureId TextureStore::add_packed(const std::string& name, std::span<const std::byte> bytes,
                                   const ImageColors& colors) {
    ContentHasher hasher;
    colors.add_to(hasher);
    hasher.add(bytes);
    return implementation_->add(name, colors, hasher.value(), [&] { return packed_image(name, bytes); });
}

TextureId TextureStore::add_pixels(const std::string& name, std::span<const float> pixels, int width, int height,
                                   int channels, const ImageColors& colors) {
    if (width <= 0 || height <= 0)
        throw InputError(name, "image size", std::to_string(width) + " x " + std::to_string(height), "at least 1 x 1");
    if (channels != 1 && channels != 3 && channels != 4)
        throw InputError(name, "image channels", std::to_string(channels), "1, 3 or 4");
    const size_t row = static_cast<size_t>(width) * static_cast<size_t>(channels);
    if (pixels.size() != row * static_cast<size_t>(height))
        throw InputError(name, "number of pixel values", std::to_string(pixels.size()),
                         std::to_string(row * static_cast<size_t>(height)));
    ContentHasher hasher;
    colors.add_to(hasher);
    for (const int number : {width, height, channels}) hasher.add(number);
    hasher.add(pixels);
    return implementation_->add(name, colors, hasher.value(),
                                [&] { return image_pixels(pixels, width, height, channels); });
}

std::vector<TextureStore::Unreadable> TextureStore::leave_out_unreadable(const CancelToken& cancel) {
    const AppendList<std::shared_ptr<const ConvertedTexture>>& textures = implementation_->textures;
    for (size_t i = 0; i < textures.size(); ++i) textures[i]->read_unless_busy();
    std::vector<Unreadable> found;
    for (size_t i = 0; i < textures.size(); ++i) {
        textures[i]->read(cancel);
        const std::optional<InputError>& refusal = textures[i]->refusal();
        if (!refusal) continue;
        textures[i]->leave_out();
        found.push_back({textures[i]->name(), refusal->what()});
    }
    return found;
}

void TextureStore::finish(const CancelToken& cancel) const {
    for (size_t i = 0; i < implementation_->textures.size(); ++i) {
        const ConvertedTexture& texture = *implementation_->textures[i];
        texture.convert(cancel);
        if (texture.refusal() && !texture.is_left_out()) throw InputError(*texture.refusal());
        if (!texture.fault().empty())
            throw InputError(texture.name(), "image", "not convertible (" + texture.fault() + ")",
                             "an image that OpenEXR can hold, and room in the temporary folder");
    }
}

TextureStore::Size TextureStore::size(TextureId id) const {
    if (id < 0 || static_cast<size_t>(id) >= implementation_->textures.size()) return {};
    const ConvertedTexture& texture = *implementation_->textures[static_cast<size_t>(id)];
    return {texture.width(), texture.height()};
}

Vec4f TextureStore::lookup(TextureId id, const Vec2f& uv, const Vec2f& duv_dx, const Vec2f& duv_dy,
                           TextureExtension extension, const TextureReading& reading) const {
    if (id < 0 || static_cast<size_t>(id) >= implementation_->textures.size()) return Vec4f(0.0f, 0.0f, 0.0f, 0.0f);
    const ConvertedTexture& texture = *implementation_->textures[static_cast<size_t>(id)];
    texture.convert();
    if (texture.refusal()) return kUnreadable;
    const Vec2f p = near_coordinates(finite_coordinates(uv), extension), dx = finite_coordinates(duv_dx),
                dy = finite_coordinates(duv_dy);
    // Without a channel that says how much of a pixel is there, the border pixels go on, and are faded by hand.
    const bool is_faded = texture.channels() < 4 && extension == TextureExtension::Clip;
    const float covered = is_faded ? covered_share(texture, p, dx, dy, reading.interpolation) : 1.0f;
    if (!(covered > 0.0f)) return Vec4f(0.0f);
    oiio::TextureOpt lookup_options = options(is_faded ? TextureExtension::Extend : extension, reading.interpolation);
    // A point needs no level of the pyramid to be found.
    if (dx == Vec2f(0.0f) && dy == Vec2f(0.0f)) lookup_options.mipmode = oiio::TextureOpt::MipModeNoMIP;
    if (texture.handle() == nullptr) return Vec4f(0.0f, 0.0f, 0.0f, 0.0f);
    float value[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    // OpenImageIO's t runs down the picture.
    texture_system().texture(static_cast<oiio::TextureSystem::TextureHandle*>(texture.handle()), nullptr,
                             lookup_options, p.x, 1.0f - p.y, dx.x, -dx.y, dy.x, -dy.y, texture.channels(), value);
    if (texture.channels() < 4) value[3] = covered;
    if (texture.channels() == 1) value[1] = value[2] = value[0];
    if (texture.associated()) read_associated(value, reading.is_multiplied, texture.is_encoded());
    return Vec4f(finite_or_zero(value[0]), finite_or_zero(value[1]), finite_or_zero(value[2]),
                 finite_or_zero(value[3]));
}

TextureStore::Statistics TextureStore::statistics() const {
    long long bytes = 0;
    texture_system().getattribute("stat:cache_memory_used", oiio::TypeDesc::INT64, &bytes);
    return {implementation_->textures.size(), static_cast<size_t>(std::max(bytes, 0LL)),
            tiles_read() - implementation_->tiles_before};
}

void TextureStore::add_to(ContentHasher& hasher) const {
    for (size_t i = 0; i < implementation_->textures.size(); ++i)
        for (const uint64_t word : implementation_->textures[i]->key()) hasher.add(word);
}

}  // namespace rayleaf
