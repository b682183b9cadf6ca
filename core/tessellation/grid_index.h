// A hash table from keys to slots of the geometry cache; lookups take no lock.
//
// If one number per key takes little of the budget, the index is an array of them, else sets of eight (key, slot)
// pairs, one cache line each. A key may lie in either of two sets, and is put in the one with more room, so that hardly
// any set is full before nearly all are (Azar, Broder, Karlin, Upfal, "Balanced allocations", STOC 1994).
#pragma once

#include "base/cache_line.h"
#include "base/zeroed_array.h"

#include <atomic>
#include <cstdint>
#include <optional>

namespace rayleaf {

class GridIndex {
  public:
    static constexpr uint32_t kNone = ~0u;

    GridIndex() = default;
    /// For `capacity` slots and keys below `keys`; `as_table` allows an array.
    GridIndex(uint32_t capacity, uint32_t keys, bool as_table);

    uint32_t find(uint32_t key) const {
        if (table_) return table_[key].load(std::memory_order_seq_cst) - 1;
        for (const uint32_t factor : kFactors) {
            const std::atomic<uint64_t>* set = set_of(key, factor);
            for (int way = 0; way < kWays; ++way) {
                const uint64_t entry = set[way].load(std::memory_order_seq_cst);
                if (static_cast<uint32_t>(entry >> 32) == key + 1) return static_cast<uint32_t>(entry);
            }
        }
        return kNone;
    }
    /// Only the lock holder may change the index. Returns the slot that was displaced from a full set, if any.
    std::optional<uint32_t> insert(uint32_t key, uint32_t slot);
    void remove(uint32_t key, uint32_t slot);
    uint64_t bytes() const;

    static uint64_t table_bytes(uint32_t keys) { return sizeof(std::atomic<uint32_t>) * uint64_t{keys}; }
    /// Bytes for this many slots in sets: a tenth more than they need, since sets never fill evenly.
    static constexpr uint64_t set_bytes(uint64_t slots) { return slots * sizeof(std::atomic<uint64_t>) * 11 / 10; }

  private:
    static constexpr int kWays = 8;
    // Entries publish the grid in a slot, to find(). Sequentially consistent, as what readers announce: see
    // tessellation/readers.h.
    struct alignas(kCacheLine) Set {
        std::atomic<uint64_t> entries[kWays];  ///< key + 1 above, slot below; 0: free
    };
    ZeroedArray<std::atomic<uint32_t>> table_;  ///< slot + 1; 0: none
    ZeroedArray<Set> sets_;
    uint32_t keys_ = 0, set_count_ = 0, next_way_ = 0;

    /// Factors of Knuth's multiplicative hash: the fractions of the golden and the silver ratio times 2^32.
    /// Neighbouring keys go to different sets.
    static constexpr uint32_t kFactors[2] = {2654435769u, 1779033703u};
    std::atomic<uint64_t>* set_of(uint32_t key, uint32_t factor) const {
        const uint32_t hash = key * factor;
        return sets_[static_cast<uint32_t>(uint64_t{hash} * set_count_ >> 32)].entries;
    }
};

}  // namespace rayleaf
