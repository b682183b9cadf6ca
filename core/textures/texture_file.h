// The file of a converted texture, as OpenImageIO reads it.
//
// By default OpenImageIO has at most a hundred files open, and closes one to open another. Two threads that do so at
// the same time can wait for each other's file without end. So to OpenImageIO all files stay open, and this class
// limits the descriptors: the first files keep one, and any other is opened for each read.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include <OpenImageIO/filesystem.h>

namespace rayleaf {

class TextureFile final : public OIIO::Filesystem::IOProxy {
  public:
    /// Of a file that is complete.
    explicit TextureFile(const std::string& path);
    ~TextureFile() override;
    TextureFile(const TextureFile&) = delete;
    TextureFile& operator=(const TextureFile&) = delete;

    const char* proxytype() const override { return "texture"; }
    size_t read(void* buffer, size_t size) override;
    size_t pread(void* buffer, size_t size, int64_t offset) override;
    size_t size() const override { return size_; }

  private:
    int kept_ = -1;  ///< descriptor; -1: none
    size_t size_ = 0;
    /// Of the file: headers are read number by number.
    std::array<std::byte, 4096> buffer_;
    int64_t buffered_at_ = 0;
    size_t buffered_ = 0;

    int open() const;
};

}  // namespace rayleaf
