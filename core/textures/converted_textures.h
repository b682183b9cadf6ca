// Images as OpenImageIO's texture system reads them, each converted once: a tiled, mip-mapped OpenEXR file in a
// temporary folder. Converting takes far longer than reading, so what has been converted is kept, known by its content.
#pragma once

#include "base/content_hash.h"
#include "base/kept_by_key.h"
#include "textures/texture_store.h"

#include <memory>

namespace rayleaf {

struct Picture;  // textures/picture.h
class TemporaryFolder;

/// A converted image; its file goes with it.
class ConvertedTexture {
  public:
    /// Throws InputError that names the image.
    ConvertedTexture(const std::string& name, Picture picture, ColorSpace space, const ContentHash& key);
    ~ConvertedTexture();
    ConvertedTexture(const ConvertedTexture&) = delete;
    ConvertedTexture& operator=(const ConvertedTexture&) = delete;

    const ContentHash& key() const { return key_; }
    void* handle() const { return handle_; }  ///< OpenImageIO's TextureHandle
    int channels() const { return channels_; }
    int width() const { return width_; }
    int height() const { return height_; }
    /// Colours are multiplied by alpha and must be divided again.
    bool associated() const { return associated_; }

  private:
    ContentHash key_;
    std::shared_ptr<TemporaryFolder> folder_;
    std::string file_;
    void* handle_ = nullptr;
    int channels_ = 0, width_ = 0, height_ = 0;
    bool associated_ = false;
};

/// Users are scenes.
class ConvertedTextures final : public KeptByKey<ContentHash, std::shared_ptr<const ConvertedTexture>> {};

}  // namespace rayleaf
