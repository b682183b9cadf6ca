// A list with room for a few items, which costs nothing to make: for what is gathered on the stack.
#pragma once

#include "base/assert.h"

#include <cstddef>
#include <new>
#include <span>
#include <type_traits>
#include <utility>

namespace rayleaf {

template <typename T, size_t kMost>
class ShortList {
    static_assert(std::is_trivially_destructible_v<T>);

  public:
    ShortList() {}
    ShortList(const ShortList&) = delete;
    ShortList& operator=(const ShortList&) = delete;

    /// There must be room.
    template <typename... Arguments>
    T& add(Arguments&&... arguments) {
        RAYLEAF_ASSERT_LT(count_, kMost);
        return *new (&items_[count_++]) T{std::forward<Arguments>(arguments)...};
    }
    size_t size() const { return count_; }
    bool empty() const { return count_ == 0; }
    T& operator[](size_t i) { return items_[i]; }
    T* begin() { return items_; }
    T* end() { return items_ + count_; }
    std::span<const T> all() const { return {items_, count_}; }

  private:
    size_t count_ = 0;
    union {
        T items_[kMost];
    };
};

}  // namespace rayleaf
