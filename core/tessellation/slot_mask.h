// A set of the slots of one unit of the geometry cache: a bit each.
#pragma once

#include <bit>
#include <cstdint>

namespace rayleaf {

class SlotMask {
  public:
    static constexpr uint32_t kMost = 64;

    SlotMask() = default;
    /// The first `count` slots, less than kMost.
    static constexpr SlotMask first(uint32_t count) {
        SlotMask mask;
        mask.word_ = (uint64_t{1} << count) - 1;
        return mask;
    }
    static constexpr SlotMask one(uint32_t slot) {
        SlotMask mask;
        mask.add(slot);
        return mask;
    }
    constexpr void add(uint32_t slot) { word_ |= uint64_t{1} << slot; }
    constexpr void remove(uint32_t slot) { word_ &= ~(uint64_t{1} << slot); }
    constexpr bool has(uint32_t slot) const { return (word_ >> slot & 1u) != 0; }
    constexpr bool empty() const { return word_ == 0; }
    /// The lowest slot; the set must not be empty.
    uint32_t lowest() const { return static_cast<uint32_t>(std::countr_zero(word_)); }
    void add(const SlotMask& other) { word_ |= other.word_; }
    bool operator==(const SlotMask&) const = default;

  private:
    uint64_t word_ = 0;
};

}  // namespace rayleaf
