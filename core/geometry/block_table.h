// A table from whole coordinates in space to numbers, for what is there at few places: open addressing, linear probes.
#pragma once

#include "base/hash64.h"
#include "base/vector.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace rayleaf {

class BlockTable {
  public:
    /// Coordinates lie nearer to 0 than this.
    static constexpr int kFarthest = 1 << 20;

    /// Keeps what is there already; false then.
    bool insert(const Vec3i& place, uint32_t number) {
        if (2 * (count_ + 1) > slots_.size()) grow();
        Slot& slot = slots_[slot_of(key_of(place))];
        if (slot.key != kEmpty) return false;
        slot = {key_of(place), number};
        ++count_;
        return true;
    }
    std::optional<uint32_t> find(const Vec3i& place) const {
        if (count_ == 0) return std::nullopt;
        const Slot& slot = slots_[slot_of(key_of(place))];
        return slot.key == kEmpty ? std::nullopt : std::optional(slot.number);
    }
    size_t size() const { return count_; }
    size_t bytes() const { return slots_.capacity() * sizeof(Slot); }
    /// `visit(place, number)` of all, in no order that means anything.
    template <typename Visit>
    void for_each(const Visit& visit) const {
        for (const Slot& slot : slots_)
            if (slot.key != kEmpty) visit(place_of(slot.key), slot.number);
    }

  private:
    static constexpr uint64_t kEmpty = ~uint64_t{0};
    static constexpr int kBits = 21;  ///< of a coordinate in a key
    struct Slot {
        uint64_t key = kEmpty;
        uint32_t number = 0;
    };
    std::vector<Slot> slots_;  ///< a power of two, or none
    size_t count_ = 0;

    static uint64_t key_of(const Vec3i& place) {
        uint64_t key = 0;
        for (int axis = 0; axis < 3; ++axis) key = (key << kBits) | static_cast<uint64_t>(place[axis] + kFarthest);
        return key;
    }
    static Vec3i place_of(uint64_t key) {
        Vec3i place;
        for (int axis = 2; axis >= 0; --axis, key >>= kBits)
            place[axis] = static_cast<int>(key & ((uint64_t{1} << kBits) - 1)) - kFarthest;
        return place;
    }
    /// Where the key is, or would be put.
    size_t slot_of(uint64_t key) const {
        const size_t mask = slots_.size() - 1;
        size_t at = static_cast<size_t>(hash64(key)) & mask;
        while (slots_[at].key != kEmpty && slots_[at].key != key) at = (at + 1) & mask;
        return at;
    }
    void grow() {
        constexpr size_t kLeast = 64;
        std::vector<Slot> before = std::move(slots_);
        slots_.assign(std::max(kLeast, 2 * before.size()), {});
        for (const Slot& slot : before)
            if (slot.key != kEmpty) slots_[slot_of(slot.key)] = slot;
    }
};

}  // namespace rayleaf
