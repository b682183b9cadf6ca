#include "textures/texture_file.h"

#include <algorithm>
#include <atomic>
#include <cstring>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

namespace rayleaf {
namespace {

/// Of those that the process may have; the rest is the host program's.
constexpr rlim_t kShareOfDescriptors = 4;

std::atomic<rlim_t> descriptors_kept{0};

/// Whether another descriptor may be kept; counts it then.
bool take_descriptor() {
    rlimit limit{};
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return false;
    if (descriptors_kept.fetch_add(1, std::memory_order_relaxed) < limit.rlim_cur / kShareOfDescriptors) return true;
    descriptors_kept.fetch_sub(1, std::memory_order_relaxed);
    return false;
}

}  // namespace

TextureFile::TextureFile(const std::string& path) : IOProxy(path, Read) {
    const int descriptor = open();
    struct stat found {};
    if (descriptor >= 0 && fstat(descriptor, &found) == 0) size_ = static_cast<size_t>(found.st_size);
    if (descriptor >= 0 && take_descriptor())
        kept_ = descriptor;
    else if (descriptor >= 0)
        ::close(descriptor);
}

TextureFile::~TextureFile() {
    if (kept_ < 0) return;
    ::close(kept_);
    descriptors_kept.fetch_sub(1, std::memory_order_relaxed);
}

int TextureFile::open() const {
    return ::open(filename().c_str(), O_RDONLY | O_CLOEXEC);
}

size_t TextureFile::read(void* buffer, size_t size) {
    size_t done;
    if (size < buffer_.size()) {
        const bool is_buffered = m_pos >= buffered_at_ &&
                                 m_pos + static_cast<int64_t>(size) <= buffered_at_ + static_cast<int64_t>(buffered_);
        if (!is_buffered) {
            buffered_ = pread(buffer_.data(), buffer_.size(), m_pos);
            buffered_at_ = m_pos;
        }
        const auto begin = static_cast<size_t>(m_pos - buffered_at_);
        done = std::min(size, buffered_ - begin);
        std::memcpy(buffer, &buffer_[begin], done);
    } else {
        done = pread(buffer, size, m_pos);
    }
    m_pos += static_cast<int64_t>(done);
    return done;
}

size_t TextureFile::pread(void* buffer, size_t size, int64_t offset) {
    const int descriptor = kept_ >= 0 ? kept_ : open();
    size_t done = 0;
    while (descriptor >= 0 && done < size) {
        const ssize_t count = ::pread(descriptor, static_cast<std::byte*>(buffer) + done, size - done,
                                      static_cast<off_t>(offset + static_cast<int64_t>(done)));
        if (count <= 0) break;
        done += static_cast<size_t>(count);
    }
    if (descriptor >= 0 && descriptor != kept_) ::close(descriptor);
    return done;
}

}  // namespace rayleaf
