// A set of the slots of one unit of the geometry cache: a bit each.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace rayleaf {

class SlotMask {
  public:
    static constexpr uint32_t kMost = 128;

    SlotMask() = default;
    /// The first `count` slots.
    static constexpr SlotMask first(uint32_t count) {
        SlotMask mask;
        for (uint32_t i = 0; i < count; ++i) mask.add(i);
        return mask;
    }
    static constexpr SlotMask one(uint32_t slot) {
        SlotMask mask;
        mask.add(slot);
        return mask;
    }
    constexpr void add(uint32_t slot) { words_[slot / 64] |= uint64_t{1} << slot % 64; }
    constexpr void remove(uint32_t slot) { words_[slot / 64] &= ~(uint64_t{1} << slot % 64); }
    constexpr bool has(uint32_t slot) const { return (words_[slot / 64] >> slot % 64 & 1u) != 0; }
    constexpr bool empty() const { return (words_[0] | words_[1]) == 0; }
    /// The lowest slot; the set must not be empty.
    uint32_t lowest() const {
        return static_cast<uint32_t>(words_[0] != 0 ? std::countr_zero(words_[0]) : 64 + std::countr_zero(words_[1]));
    }
    void add(const SlotMask& other) {
        words_[0] |= other.words_[0];
        words_[1] |= other.words_[1];
    }
    bool operator==(const SlotMask&) const = default;

  private:
    std::array<uint64_t, kMost / 64> words_{};
};

}  // namespace rayleaf
