#include "textures/converted_textures.h"

#include "base/error.h"
#include "textures/picture.h"
#include "textures/texture_system.h"

#include <atomic>
#include <filesystem>
#include <mutex>

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <unistd.h>

namespace rayleaf {
namespace {

namespace oiio = OIIO;

constexpr int kTile = 64;  ///< pixels; what OpenImageIO's own tool makes

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

  private:
    std::filesystem::path path_;
    std::atomic<uint64_t> files_{0};
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

}  // namespace

oiio::TextureSystem& texture_system() {
    // A plain pointer until OpenImageIO 2.5, a shared one since 3.0: behind a reference neither is ever destroyed.
    static const auto& system = *new auto(oiio::TextureSystem::create(false));
    return *system;
}

ConvertedTexture::ConvertedTexture(const std::string& name, Picture picture, ColorSpace space, const ContentHash& key)
    : key_(key), folder_(temporary_folder()), file_(folder_->file()) {
    prepare(picture, space);
    oiio::ImageSpec spec(picture.width, picture.height, picture.channels, oiio::TypeDesc::FLOAT);
    const oiio::ImageBuf buffer(spec, picture.pixels.data());
    oiio::ImageSpec config;
    config.tile_width = config.tile_height = kTile;
    config.format = picture.precise ? oiio::TypeDesc::FLOAT : oiio::TypeDesc::HALF;
    config.attribute("maketx:fileformatname", "openexr");
    config.attribute("compression", "zip");
    if (!oiio::ImageBufAlgo::make_texture(oiio::ImageBufAlgo::MakeTxTexture, buffer, file_, config))
        throw InputError(name, "image", "not convertible (" + oiio::geterror() + ")", "a texture in '" + file_ + "'");
    auto* handle = texture_system().get_texture_handle(oiio::ustring(file_));
    handle_ = handle;
    channels_ = picture.channels;
    width_ = picture.width;
    height_ = picture.height;
    associated_ = picture.alpha_channel() >= 0 && space != ColorSpace::NonColor;
    if (handle == nullptr || !texture_system().good(handle))
        throw InputError(name, "image", "not readable after conversion (" + texture_system().geterror() + ")",
                         "a texture");
}

ConvertedTexture::~ConvertedTexture() {
    texture_system().invalidate(oiio::ustring(file_));
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
}

}  // namespace rayleaf
