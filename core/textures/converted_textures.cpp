#include "textures/converted_textures.h"

#include "base/error.h"
#include "textures/mip_level.h"
#include "textures/picture.h"
#include "textures/texture_file.h"
#include "textures/texture_system.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <filesystem>
#include <limits>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include <OpenImageIO/imageio.h>
#include <oneapi/tbb/task_arena.h>
#include <unistd.h>

namespace rayleaf {
namespace {

namespace oiio = OIIO;

constexpr int kTile = 64;  ///< pixels; what OpenImageIO's own tool makes
/// Files that take more than this together are compressed, bytes: that takes many times as long as writing them.
constexpr uint64_t kMostUncompressed = uint64_t{4} << 30;

}  // namespace

/// A folder of its own under the system's temporary one, removed with the object.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::string name =
            (std::filesystem::temp_directory_path() / ("rayleaf_textures_" + std::to_string(getpid()) + "_XXXXXX"))
                .string();
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

    /// A name that no other has.
    std::string file() {
        return (path_ / (std::to_string(files_.fetch_add(1, std::memory_order_relaxed)) + ".exr")).string();
    }

    /// Takes room for a file of so many bytes: all, or 0 where it is to be compressed.
    uint64_t take(uint64_t bytes) {
        if (bytes_.fetch_add(bytes, std::memory_order_relaxed) + bytes <= kMostUncompressed) return bytes;
        give_back(bytes);
        return 0;
    }
    void give_back(uint64_t bytes) { bytes_.fetch_sub(bytes, std::memory_order_relaxed); }

  private:
    std::filesystem::path path_;
    std::atomic<uint64_t> files_{0}, bytes_{0};
};

namespace {

/// That of all textures there are: it goes with the last.
std::shared_ptr<TemporaryFolder> temporary_folder() {
    static std::mutex mutex;
    static std::weak_ptr<TemporaryFolder> known;
    const std::scoped_lock lock(mutex);
    std::shared_ptr<TemporaryFolder> folder = known.lock();
    if (!folder) known = folder = std::make_shared<TemporaryFolder>();
    return folder;
}

/// Bytes of all levels, uncompressed.
uint64_t bytes_of(const Picture& picture) {
    const uint64_t level = picture.count() * (picture.precise ? sizeof(float) : sizeof(float) / 2);
    return level + level / 3;
}

/// Of its numbers in the file.
oiio::TypeDesc format_of(const Picture& picture) {
    return picture.precise ? oiio::TypeDesc::FLOAT : oiio::TypeDesc::HALF;
}

/// The nearest half float, of two the even one, of a number that a half float can hold. Without branches, so that
/// compilers make it of vectors; the library's takes many times as long.
uint16_t half_of(float x) {
    constexpr uint32_t kSign = 1u << 31, kLeastNormal = 113u << 23, kDropped = 13;
    const auto bits = std::bit_cast<uint32_t>(x), size = bits & ~kSign;
    // The exponent's bias goes from 127 to 15; what is dropped rounds up from its half, or above it where that is even.
    const uint32_t normal = (size - (112u << 23) + 0xfffu + ((size >> kDropped) & 1u)) >> kDropped;
    // Below the least normal half all have one exponent: that of 1/2, whose last bit is theirs. The sum rounds.
    const uint32_t small = std::bit_cast<uint32_t>(std::bit_cast<float>(size) + 0.5f) - std::bit_cast<uint32_t>(0.5f);
    return static_cast<uint16_t>((size < kLeastNormal ? small : normal) | (bits & kSign) >> 16);
}

/// Adds a level to a file that is open for it, some rows of tiles at a time. Whether all was well.
bool write_level(oiio::ImageOutput& output, const Picture& level, const CancelToken& cancel) {
    constexpr size_t kAtOnce = size_t{1} << 20;  ///< numbers, about
    const size_t row = level.row();
    const int rows = kTile * static_cast<int>(std::max(kAtOnce / (row * kTile), size_t{1}));
    std::vector<uint16_t> halves;
    for (int y = 0; y < level.height; y += rows) {
        cancel.throw_if_cancelled();
        const int end = std::min(y + rows, level.height);
        const std::span<const float> numbers(&level.pixels[static_cast<size_t>(y) * row],
                                             static_cast<size_t>(end - y) * row);
        const void* data = numbers.data();
        if (!level.precise) {
            halves.resize(numbers.size());
            std::ranges::transform(numbers, halves.begin(), half_of);
            data = halves.data();
        }
        if (!output.write_tiles(0, level.width, y, end, 0, 1, format_of(level), data)) return false;
    }
    return true;
}

/// Writes a prepared picture and its coarser levels. What went wrong, or nothing.
std::string write_levels(const Picture& picture, const std::string& file, const char* compression,
                         const CancelToken& cancel) {
    const std::unique_ptr<oiio::ImageOutput> output = oiio::ImageOutput::create(file);
    if (!output) return oiio::geterror();
    const Picture* level = &picture;
    Picture coarser;
    for (auto mode = oiio::ImageOutput::Create;; mode = oiio::ImageOutput::AppendMIPLevel) {
        oiio::ImageSpec spec(level->width, level->height, level->channels, format_of(*level));
        spec.tile_width = spec.tile_height = kTile;
        spec.tile_depth = 1;
        spec.attribute("textureformat", "Plain Texture");
        spec.attribute("compression", compression);
        if (!output->open(file, spec, mode) || !write_level(*output, *level, cancel)) return output->geterror();
        if (level->width == 1 && level->height == 1) return output->close() ? std::string() : output->geterror();
        coarser = coarser_level(*level, cancel);
        level = &coarser;
    }
}

// Plain pointers until OpenImageIO 2.5, shared ones since 3.0: behind a reference neither is ever destroyed.
const auto& image_cache() {
    static const auto& cache = *new auto([] {
        auto made = oiio::ImageCache::create(false);
        made->attribute("max_open_files", std::numeric_limits<int>::max());  // see texture_file.h
        return made;
    }());
    return cache;
}

}  // namespace

oiio::ImageCache& texture_files() {
    return *image_cache();
}

oiio::TextureSystem& texture_system() {
    static const auto& system = *new auto(oiio::TextureSystem::create(false, image_cache()));
    return *system;
}

ConvertedTexture::ConvertedTexture(std::string name, ImageSource source, ImageColors colors, const ContentHash& key)
    : name_(std::move(name)),
      colors_(std::move(colors)),
      key_(key),
      folder_(temporary_folder()),
      file_(folder_->file()),
      source_(std::move(source.read)) {
    normalize(source.outline);
    channels_ = source.outline.channels;
    width_ = source.outline.width;
    height_ = source.outline.height;
    associated_ = source.outline.alpha_channel() >= 0 && source.outline.alpha != Alpha::Separate &&
                  colors_.space != ColorSpace::NonColor;
    encoded_ = colors_.space == ColorSpace::Srgb && !source.outline.precise;
}

size_t ConvertedTexture::picture_bytes() const {
    return static_cast<size_t>(width_) * static_cast<size_t>(height_) * static_cast<size_t>(channels_) * sizeof(float);
}

/// The channels that are wanted, and what the fourth is.
void ConvertedTexture::normalize(Picture& picture) const {
    normalize_channels(picture, colors_.alpha);
    if (colors_.alpha == ImageAlpha::Multiplied) picture.alpha = Alpha::Associated;
    if (colors_.alpha == ImageAlpha::Separate || colors_.alpha == ImageAlpha::Ignored) picture.alpha = Alpha::Separate;
}

/// Waits until no other thread is at it.
std::unique_lock<std::mutex> ConvertedTexture::alone(const CancelToken& cancel) const {
    constexpr std::chrono::milliseconds kPatience(1);
    std::unique_lock<std::mutex> lock(mutex_, std::try_to_lock);
    while (!lock.owns_lock()) {
        cancel.throw_if_cancelled();
        std::this_thread::sleep_for(kPatience);
        lock = std::unique_lock<std::mutex>(mutex_, std::try_to_lock);
    }
    return lock;
}

/// Takes the pixels from where they come from; under the lock.
void ConvertedTexture::take() const {
    if (is_read()) return;
    try {
        picture_ = source_();
        normalize(picture_);
    } catch (const InputError& error) {
        refusal_ = error;
    }
    source_ = nullptr;
    read_.store(true, std::memory_order_release);
}

void ConvertedTexture::read(const CancelToken& cancel) const {
    if (is_read()) return;
    const std::unique_lock<std::mutex> lock = alone(cancel);
    take();
}

void ConvertedTexture::read_unless_busy() const {
    const std::unique_lock<std::mutex> lock(mutex_, std::try_to_lock);
    if (lock.owns_lock()) take();
}

void ConvertedTexture::convert(const CancelToken& cancel) const {
    if (is_converted()) return;
    const std::unique_lock<std::mutex> lock = alone(cancel);
    if (is_converted()) return;
    cancel.throw_if_cancelled();
    // Isolated: a thread that waits for parts of one image must not begin with another.
    tbb::this_task_arena::isolate([&] { make(cancel); });
    converted_.store(true, std::memory_order_release);
}

void ConvertedTexture::make(const CancelToken& cancel) const {
    take();
    if (refusal_) return;
    prepare(picture_, colors_, cancel);
    if (bytes_ == 0) bytes_ = folder_->take(bytes_of(picture_));
    fault_ = write_levels(picture_, file_, bytes_ > 0 ? "none" : "zip", cancel);
    picture_ = {};
    if (!fault_.empty()) return;
    opened_ = std::make_unique<TextureFile>(file_);
    oiio::ImageSpec how;
    void* const opened = static_cast<oiio::Filesystem::IOProxy*>(opened_.get());
    how.attribute("oiio:ioproxy", oiio::TypeDesc::PTR, &opened);
    texture_files().add_file(oiio::ustring(file_), nullptr, &how);
    auto* handle = texture_system().get_texture_handle(oiio::ustring(file_));
    if (handle != nullptr && texture_system().good(handle))
        handle_ = handle;
    else
        fault_ = "unreadable then: " + texture_system().geterror();
}

ConvertedTexture::~ConvertedTexture() {
    texture_system().invalidate(oiio::ustring(file_));
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
    folder_->give_back(bytes_);
}

}  // namespace rayleaf
