// Memory for large tables with random access: in large pages if the system has them, which makes first use and address
// translation cheap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <type_traits>

namespace rayleaf {

inline constexpr size_t kLargePage = size_t{1} << 21;

struct LargeMemoryDeleter {
    void operator()(std::byte* memory) const { ::operator delete[](memory, std::align_val_t{kLargePage}); }
};
/// Aligned to kLargePage.
using LargeMemory = std::unique_ptr<std::byte[], LargeMemoryDeleter>;

/// Not initialised; null if there is none. The system provides it as it is used, the first `small_bytes` in small
/// pages, so that a table of which little is used stays small.
LargeMemory large_memory(size_t bytes, size_t small_bytes);

/// An array of numbers or records without constructors, not initialised, aligned to 64 bytes; in large pages if it
/// fills one.
template <typename T>
class LargeArray {
  public:
    LargeArray() = default;
    /// Throws std::bad_alloc.
    explicit LargeArray(size_t size) : size_(size) {
        static_assert(std::is_trivially_destructible_v<T> && alignof(T) <= kAlignment);
        const size_t bytes = size * sizeof(T);
        if (bytes >= kLargePage)
            large_ = large_memory(bytes, 0);
        else
            small_.reset(static_cast<std::byte*>(::operator new[](bytes, std::align_val_t{kAlignment})));
        if (bytes >= kLargePage && !large_) throw std::bad_alloc();
        first_ = reinterpret_cast<T*>(large_ ? large_.get() : small_.get());
    }
    size_t size() const { return size_; }
    uint64_t bytes() const { return size_ * sizeof(T); }
    T* data() { return first_; }
    const T* data() const { return first_; }
    T& operator[](size_t i) { return first_[i]; }
    const T& operator[](size_t i) const { return first_[i]; }

  private:
    static constexpr size_t kAlignment = 64;
    struct Deleter {
        void operator()(std::byte* memory) const { ::operator delete[](memory, std::align_val_t{kAlignment}); }
    };
    LargeMemory large_;
    std::unique_ptr<std::byte[], Deleter> small_;
    T* first_ = nullptr;
    size_t size_ = 0;
};

}  // namespace rayleaf
