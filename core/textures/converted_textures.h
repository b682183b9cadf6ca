// Images as OpenImageIO's texture system reads them, each converted once: a tiled, mip-mapped OpenEXR file in a
// temporary folder. Converting takes far longer than reading, so what has been converted is kept, known by its content.
#pragma once

#include "base/content_hash.h"
#include "textures/texture_store.h"

#include <map>
#include <memory>
#include <mutex>

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
    /// Colours are multiplied by alpha and must be divided again.
    bool associated() const { return associated_; }

  private:
    ContentHash key_;
    std::shared_ptr<TemporaryFolder> folder_;
    std::string file_;
    void* handle_ = nullptr;
    int channels_ = 0;
    bool associated_ = false;
};

/// Thread-safe. What no scene has asked for while the last two were made is dropped.
class ConvertedTextures {
  public:
    /// For each scene, before it asks.
    void next_scene();
    /// Null where there is none.
    std::shared_ptr<const ConvertedTexture> find(const ContentHash& key);
    void keep(std::shared_ptr<const ConvertedTexture> texture);

  private:
    struct Entry {
        std::shared_ptr<const ConvertedTexture> texture;
        uint64_t asked = 0;  ///< scene that asked last
    };
    std::mutex mutex_;
    std::map<ContentHash, Entry> entries_;
    uint64_t scenes_ = 0;
};

}  // namespace rayleaf
