// The door to Open Image Denoise, by its C interface, of versions 1 and 2. The library is looked for when somebody
// asks: most renders do without it.
#pragma once

#include "base/cancel.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace rayleaf {

/// How the passes that guide a denoiser are taken.
enum class DenoisingGuides : uint8_t {
    AsTheyAre,  ///< for free of noise
    Noisy,      ///< denoised together with the picture
    Denoised    ///< first, each by itself
};

/// A picture, rows of red, green and blue; and as many albedos and normals that guide, or none.
struct NoisyPicture {
    int width = 0, height = 0;
    std::span<const float> color, albedo, normal;
    DenoisingGuides guides = DenoisingGuides::Denoised;
};

class Denoiser {
  public:
    /// The library that the process has; else the first of these paths, or of the system's names for it, that can be
    /// loaded. `threads`: 0 for all of the machine's. Throws InputError that says what was tried, or what is wrong with
    /// the library.
    explicit Denoiser(const std::vector<std::string>& paths, int threads = 0);
    ~Denoiser();
    Denoiser(const Denoiser&) = delete;
    Denoiser& operator=(const Denoiser&) = delete;

    /// Such as 2.3.3.
    const std::string& version() const { return version_; }
    /// Throws InputError where sizes do not match or the library fails, and Cancelled soon after `cancel` says so.
    std::vector<float> denoised(const NoisyPicture& picture, const CancelToken& cancel = kNeverCancelled) const;

  private:
    struct Library;
    std::unique_ptr<const Library> library_;
    void* device_ = nullptr;
    std::string version_;

    void throw_error() const;
    void filter(const NoisyPicture& picture, const char* image, std::vector<float>& output,
                const CancelToken& cancel) const;
};

}  // namespace rayleaf
