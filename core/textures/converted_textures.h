// Images as OpenImageIO's texture system reads them, each converted once: a tiled, mip-mapped OpenEXR file in a
// temporary folder. Converting takes far longer than reading, so what has been converted is kept, known by its content,
// and images are converted while the rest of the scene is described.
#pragma once

#include "base/content_hash.h"
#include "base/error.h"
#include "base/kept_by_key.h"
#include "textures/image_source.h"

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace rayleaf {

class TemporaryFolder;
class TextureFile;

/// An image that is converted, or will be before it is looked up; its file goes with it. Thread-safe.
class ConvertedTexture {
  public:
    ConvertedTexture(std::string name, ImageSource source, ImageColors colors, const ContentHash& key);
    ~ConvertedTexture();
    ConvertedTexture(const ConvertedTexture&) = delete;
    ConvertedTexture& operator=(const ConvertedTexture&) = delete;

    /// Reads its pixels, or waits until another thread has. Throws Cancelled soon after `cancel` says so.
    void read(const CancelToken& cancel = kNeverCancelled) const;
    /// The same, but leaves it where another thread is at it.
    void read_unless_busy() const;
    /// Reads and converts it, or waits until another thread has. Throws Cancelled soon after `cancel` says so; the next
    /// call goes on from there.
    void convert(const CancelToken& cancel = kNeverCancelled) const;
    /// After `read`: why it cannot be read.
    const std::optional<InputError>& refusal() const { return refusal_; }
    /// After `convert`: what else went wrong, or nothing.
    const std::string& fault() const { return fault_; }
    /// It is known that it cannot be used.
    bool has_failed() const { return is_converted() && (refusal_ || !fault_.empty()); }
    /// One that cannot be read is rendered as it is.
    void leave_out() const { left_out_.store(true, std::memory_order_relaxed); }
    bool is_left_out() const { return left_out_.load(std::memory_order_relaxed); }
    const std::string& name() const { return name_; }

    const ContentHash& key() const { return key_; }
    /// OpenImageIO's TextureHandle, after `convert`; null where that failed.
    void* handle() const { return handle_; }
    int channels() const { return channels_; }
    int width() const { return width_; }
    int height() const { return height_; }
    /// Of its pixels as numbers.
    size_t picture_bytes() const;
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
    mutable std::atomic<bool> left_out_{false};
    mutable std::mutex mutex_;                 ///< held while it is read or converted; guards all below
    mutable std::function<Picture()> source_;  ///< until it is read
    mutable Picture picture_;                  ///< from then until it is converted
    mutable std::optional<InputError> refusal_;
    mutable std::string fault_;
    mutable uint64_t bytes_ = 0;                   ///< that its file takes of the folder's
    mutable std::unique_ptr<TextureFile> opened_;  ///< what the handle reads from
    mutable void* handle_ = nullptr;
    // From then on nothing changes of what it leaves behind.
    mutable std::atomic<bool> read_{false}, converted_{false};

    bool is_converted() const { return converted_.load(std::memory_order_acquire); }  // pairs with that in `convert`
    bool is_read() const { return read_.load(std::memory_order_acquire); }            // pairs with that in `take`
    std::unique_lock<std::mutex> alone(const CancelToken& cancel) const;
    void normalize(Picture& picture) const;
    void take() const;
    void make(const CancelToken& cancel) const;
};

/// Users are scenes.
class ConvertedTextures final : public KeptByKey<ContentHash, std::shared_ptr<const ConvertedTexture>> {};

}  // namespace rayleaf
