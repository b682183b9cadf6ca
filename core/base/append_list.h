// A list that one thread appends to while others read: its elements never move.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <memory>

namespace rayleaf {

template <typename T>
class AppendList {
  public:
    size_t size() const { return size_.load(std::memory_order_acquire); }  // pairs with the release in `append`
    /// Below size().
    const T& operator[](size_t index) const {
        const Place place = place_of(index);
        return parts_[place.part][place.within];
    }
    /// Only one thread may append at a time.
    void append(T value) {
        const size_t index = size_.load(std::memory_order_relaxed);
        const Place place = place_of(index);
        if (!parts_[place.part]) parts_[place.part] = std::make_unique<T[]>(kFirst << place.part);
        parts_[place.part][place.within] = std::move(value);
        size_.store(index + 1, std::memory_order_release);  // publishes the value and its part
    }

  private:
    static constexpr size_t kFirst = 16, kParts = 40;
    struct Place {
        size_t part, within;
    };

    std::array<std::unique_ptr<T[]>, kParts> parts_;  ///< each twice as long as the one before
    std::atomic<size_t> size_{0};

    static Place place_of(size_t index) {
        const size_t parts = std::bit_floor(index / kFirst + 1);
        return {static_cast<size_t>(std::countr_zero(parts)), index - kFirst * (parts - 1)};
    }
};

}  // namespace rayleaf
