// The slots of one level of the geometry cache: which subpatch's grid each holds, and which goes next.
//
// Looking up takes no lock: an index leads from the subpatch to a slot. Where a number for each subpatch takes little
// of the budget the index is a table of them, else sets of eight (subpatch, slot) pairs, each set a cache line. Changes
// are made under a lock that is never waited for: who finds it taken does without. The next slot to go is found by a
// clock: a hand goes round and takes the first whose mark was not set since it last came by.
#pragma once

#include "tessellation/readers.h"

#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace rayleaf {

class GridIndex {
  public:
    static constexpr uint32_t kNone = ~0u;

    GridIndex() = default;
    /// `capacity` slots for keys below `keys`; as a table, if that may be.
    GridIndex(uint32_t capacity, uint32_t keys, bool as_table);

    uint32_t find(uint32_t key) const {
        if (table_) return table_[key].load(std::memory_order_seq_cst) - 1;
        const std::atomic<uint64_t>* set = set_of(key);
        for (int way = 0; way < kWays; ++way) {
            const uint64_t entry = set[way].load(std::memory_order_seq_cst);
            if (static_cast<uint32_t>(entry >> 32) == key + 1) return static_cast<uint32_t>(entry);
        }
        return kNone;
    }
    /// Changes are the lock holder's. Returns the slot that lost its place in a full set, if one did.
    std::optional<uint32_t> insert(uint32_t key, uint32_t slot);
    void remove(uint32_t key, uint32_t slot);
    uint64_t bytes() const;

    static uint64_t table_bytes(uint32_t keys) { return sizeof(std::atomic<uint32_t>) * uint64_t{keys}; }
    static constexpr double kSetBytesPerSlot = 12.0;  ///< sets are two thirds full

  private:
    static constexpr int kWays = 8;
    struct alignas(64) Set {
        std::atomic<uint64_t> entries[kWays];  ///< key + 1 above, slot below; 0: free
    };
    std::unique_ptr<std::atomic<uint32_t>[]> table_;  ///< slot + 1; 0: none
    std::unique_ptr<Set[]> sets_;
    uint32_t keys_ = 0, set_count_ = 0, next_way_ = 0;

    /// Keys of neighbours go to different sets (Knuth's multiplicative hash).
    std::atomic<uint64_t>* set_of(uint32_t key) const {
        const uint32_t hash = key * 2654435769u;
        return sets_[static_cast<uint32_t>(uint64_t{hash} * set_count_ >> 32)].entries;
    }
};

/// Slot numbers and who has them; the grids themselves lie elsewhere.
class GridSlots {
  public:
    /// As many slots of `slot_bytes` as fit `budget` with all that is needed to keep track of them.
    GridSlots(uint64_t budget, uint64_t slot_bytes, uint32_t keys);

    uint32_t capacity() const { return capacity_; }
    bool full() const { return used_.load(std::memory_order_relaxed) >= capacity_; }
    /// The slot of a key, which it marks as used; kNone if there is none.
    uint32_t find(uint32_t key) const {
        if (capacity_ == 0) return GridIndex::kNone;
        const uint32_t slot = index_.find(key);
        if (slot != GridIndex::kNone && marks_[slot].load(std::memory_order_relaxed) == 0)
            marks_[slot].store(1, std::memory_order_relaxed);
        return slot;
    }
    /// A slot that no one sees, for the caller to fill; empty if none is free now.
    std::optional<uint32_t> acquire(ReaderEpochs& epochs);
    /// Makes a filled slot visible. False if that cannot be now: the slot stays the caller's.
    bool publish(uint32_t key, uint32_t slot, ReaderEpochs& epochs);
    /// While slots run out all the time: whether a key has missed before, not long ago; only those are worth a slot.
    bool missed_lately(uint32_t key);

    uint64_t slots_in_use() const { return used_.load(std::memory_order_relaxed); }
    uint64_t tracking_bytes() const;

  private:
    struct Retired {
        uint32_t slot;
        uint64_t stamp;
    };
    uint32_t capacity_ = 0;
    GridIndex index_;
    std::unique_ptr<std::atomic<uint8_t>[]> marks_;
    std::unique_ptr<std::atomic<uint32_t>[]> missed_;  ///< key + 1 of late misses, by hash
    std::vector<uint32_t> keys_;                       ///< key + 1 of each visible slot; 0: not visible
    std::deque<Retired> retired_;
    std::vector<uint32_t> free_;
    std::atomic<uint32_t> used_{0};  ///< slots handed out for the first time so far
    uint32_t hand_ = 0;
    std::mutex mutex_;

    void retire(uint32_t slot, ReaderEpochs& epochs);
    void make_room(ReaderEpochs& epochs);
};

}  // namespace rayleaf
