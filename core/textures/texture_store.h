// The scene's image textures: footprint in, filtered linear colour out, through OpenImageIO's TextureSystem.
#pragma once

#include "base/cancel.h"
#include "base/content_hash.h"
#include "base/vector.h"
#include "textures/color_transform.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace rayleaf {

using TextureId = int32_t;

class ConvertedTextures;  // textures/converted_textures.h

enum class ColorSpace : uint8_t { Srgb, Linear, NonColor };

/// What an image's fourth channel is.
enum class ImageAlpha : uint8_t {
    Opacity,     ///< of the colours; a file tells whether they come multiplied by it, pixels in memory do not
    Multiplied,  ///< the same, of colours that come multiplied by it
    Separate,    ///< a channel like others: colours are what the image holds (Blender's Channel Packed)
    Ignored      ///< nothing: the image is opaque (Blender's None)
};

/// How an image's numbers are meant: by a space that everyone knows, or by one of a configuration.
struct ImageColors {
    ColorSpace space = ColorSpace::Srgb;
    std::shared_ptr<const ColorTransform> transform = nullptr;  ///< in place of the space
    ImageAlpha alpha = ImageAlpha::Opacity;

    ImageColors(ColorSpace known, ImageAlpha fourth = ImageAlpha::Opacity) : space(known), alpha(fourth) {}
    ImageColors(std::shared_ptr<const ColorTransform> by, ImageAlpha fourth)
        : space(ColorSpace::Linear), transform(std::move(by)), alpha(fourth) {}
    void add_to(ContentHasher& hasher) const;
};
enum class TextureExtension : uint8_t {
    Repeat,
    Extend,    ///< the border pixels go on
    Clip,      ///< transparent black outside
    Mirror,    ///< every second repetition is mirrored
    Panorama,  ///< repeats along u, extends along v: a direction's longitude and latitude
};
enum class TextureInterpolation : uint8_t { Linear, Closest, Cubic };

/// How pixels become what is looked up.
struct TextureReading {
    TextureInterpolation interpolation = TextureInterpolation::Linear;
    /// The colour comes multiplied by its alpha: as Cycles multiplies it, which for images of bytes in sRGB does so
    /// before they are decoded.
    bool is_multiplied = false;
};

/// Created only for scenes that have textures. Lookups are thread-safe, also while one thread adds a texture, and never
/// wait for one another's files longer than the library does; a lookup never throws.
class TextureStore {
  public:
    /// `memory_limit` in bytes, for cached tiles, at least 10 MB. Stores that live at the same time share one cache;
    /// the limit is that of the newest. `converted`: images that were converted before; null: none.
    explicit TextureStore(size_t memory_limit, std::shared_ptr<ConvertedTextures> converted = nullptr);
    ~TextureStore();
    TextureStore(const TextureStore&) = delete;
    TextureStore& operator=(const TextureStore&) = delete;

    // Adding reads a header; pixels are read and converted by other threads from then on.

    /// An image file. Throws InputError that names `name` and the path if it is missing or its header cannot be read.
    /// `picture`: which one of a file that has several, like a movie.
    TextureId add_file(const std::string& name, const std::string& path, const ImageColors& colors, int picture = 0);
    /// What an image file holds, as bytes in memory. Throws InputError that names `name` where the header cannot be
    /// read.
    TextureId add_packed(const std::string& name, std::span<const std::byte> bytes, const ImageColors& colors);
    /// Pixels as Blender holds them: `channels` floats each (1, 3 or 4), rows bottom to top.
    TextureId add_pixels(const std::string& name, std::span<const float> pixels, int width, int height, int channels,
                         const ImageColors& colors);

    /// An image by its name, and what is wrong with it.
    struct Unreadable {
        std::string name, reason;
    };
    /// Waits until all images are read. Those that cannot be are pink from now on, and said.
    std::vector<Unreadable> leave_out_unreadable(const CancelToken& cancel);
    /// Waits until all images are converted. Throws InputError that names one that could not be, unless it was left
    /// out, Cancelled soon after `cancel` says so.
    void finish(const CancelToken& cancel) const;

    /// All that lookups depend on.
    void add_to(ContentHasher& hasher) const;

    /// Pixels from side to side and from top to bottom; 0 where there is no such texture.
    struct Size {
        int width = 0, height = 0;
    };
    Size size(TextureId id) const;

    /// Filtered linear colour with alpha in w at (u, v), v up as in Blender. The derivatives are changes of (u, v) per
    /// pixel.
    Vec4f lookup(TextureId id, const Vec2f& uv, const Vec2f& duv_dx, const Vec2f& duv_dy, TextureExtension extension,
                 const TextureReading& reading) const;

    /// Bytes of tiles cached now, tiles read since this store was made; both of all stores together.
    struct Statistics {
        size_t textures = 0, bytes = 0, file_reads = 0;
    };
    Statistics statistics() const;

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace rayleaf
