// A buffer of run-time size that lives on the stack up to a capacity and on the heap beyond it.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace rayleaf {

template <typename T, size_t Capacity>
class StackBuffer {
  public:
    explicit StackBuffer(size_t size) {
        if (size > Capacity) heap_.resize(size);
    }
    T* data() { return heap_.empty() ? stack_.data() : heap_.data(); }
    const T* data() const { return heap_.empty() ? stack_.data() : heap_.data(); }
    T& operator[](size_t index) { return data()[index]; }

  private:
    std::array<T, Capacity> stack_;  // left uninitialized for plain numbers: callers write before they read
    std::vector<T> heap_;
};

}  // namespace rayleaf
