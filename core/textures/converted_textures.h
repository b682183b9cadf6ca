// Images as OpenImageIO's texture system reads them, each converted once: a tiled, mip-mapped OpenEXR file in a
// temporary folder. Converting takes far longer than reading, so what has been converted is kept, known by its content,
// and images are converted while the rest of the scene is described.
#pragma once

#include "base/content_hash.h"
#include "base/kept_by_key.h"
#include "textures/picture.h"

#include <atomic>
#include <memory>
#include <mutex>
#include <string>

namespace rayleaf {

class TemporaryFolder;

/// An image that is converted, or will be before it is looked up; its file goes with it. Thread-safe.
class ConvertedTexture {
  public:
    ConvertedTexture(std::string name, Picture picture, ImageColors colors, const ContentHash& key);
    ~ConvertedTexture();
    ConvertedTexture(const ConvertedTexture&) = delete;
    ConvertedTexture& operator=(const ConvertedTexture&) = delete;

    /// Converts it, or waits until another thread has. Throws Cancelled soon after `cancel` says so; the next call goes
    /// on from there.
    void convert(const CancelToken& cancel = kNeverCancelled) const;
    bool is_converted() const { return converted_.load(std::memory_order_acquire); }  // pairs with that in `convert`
    /// After `convert`: what went wrong, or nothing.
    const std::string& fault() const { return fault_; }
    const std::string& name() const { return name_; }

    const ContentHash& key() const { return key_; }
    /// OpenImageIO's TextureHandle, after `convert`; null where that failed.
    void* handle() const { return handle_; }
    int channels() const { return channels_; }
    int width() const { return width_; }
    int height() const { return height_; }
    /// Colours are multiplied by alpha and must be divided again.
    bool associated() const { return associated_; }
    /// It was of bytes in sRGB.
    bool is_encoded() const { return encoded_; }

  private:
    std::string name_;
    ImageColors colors_;
    ContentHash key_;
    std::shared_ptr<TemporaryFolder> folder_;
    std::string file_;
    int channels_ = 0, width_ = 0, height_ = 0;
    bool associated_ = false, encoded_ = false;
    mutable std::mutex mutex_;  ///< held while it is converted; guards all below
    mutable Picture picture_;   ///< until it is converted
    mutable std::string fault_;
    mutable uint64_t bytes_ = 0;  ///< that its file takes of the folder's
    mutable void* handle_ = nullptr;
    mutable std::atomic<bool> converted_{false};  ///< nothing changes any more

    void make(const CancelToken& cancel) const;
};

/// Users are scenes.
class ConvertedTextures final : public KeptByKey<ContentHash, std::shared_ptr<const ConvertedTexture>> {};

}  // namespace rayleaf
