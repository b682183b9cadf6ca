// Arrays of zeros that the system provides page by page as they are used: reserved but unused parts cost
// nothing.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>

namespace rayleaf {

/// For types for which all bits zero are a valid value: numbers, atomic numbers, and structures of them.
template <typename T>
class ZeroedArray {
    static_assert(std::is_trivially_destructible_v<T>);

  public:
    ZeroedArray() = default;
    /// Throws std::bad_alloc.
    explicit ZeroedArray(size_t count) : memory_(std::calloc(count * sizeof(T) + alignof(T), 1)) {
        if (!memory_) throw std::bad_alloc();
        void* first = memory_.get();
        size_t space = count * sizeof(T) + alignof(T);
        values_ = static_cast<T*>(std::align(alignof(T), count * sizeof(T), first, space));
    }
    explicit operator bool() const { return values_ != nullptr; }
    T& operator[](size_t i) const { return values_[i]; }

  private:
    struct Free {
        void operator()(void* memory) const { std::free(memory); }
    };
    std::unique_ptr<void, Free> memory_;
    T* values_ = nullptr;
};

}  // namespace rayleaf
