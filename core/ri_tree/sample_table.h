// The samples of lattice points, shared by the cells that meet there: a table that may forget.
//
// Samples are pure functions of their points, so one that was dropped, or that another thread is reading or writing
// right now, is traced again. No thread waits: a locked slot counts as a miss.
//
// Samples are stored in chunks, in the order in which they come; a hash table holds their numbers. Only the hash table
// grows. Once memory is at its limit the oldest sample is replaced: when the view moves on, the newest samples are
// those that neighbouring cells will ask for.
#pragma once

#include "base/cache_line.h"
#include "ri_tree/fast_sample.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

namespace rayleaf {

class SampleTable {
  public:
    /// Takes at most `most_bytes`, and starts small.
    SampleTable(OutputKind kind, SampleContents contents, uint64_t most_bytes);
    ~SampleTable();
    SampleTable(const SampleTable&) = delete;
    SampleTable& operator=(const SampleTable&) = delete;

    /// A lattice point and its hash.
    struct Key {
        LatticePoint point;
        uint32_t mark = 0;
    };
    static Key key_of(const LatticePoint& point);

    /// Prefetches the entry of a key, then its sample: call the first for all keys, then the second for all.
    void prefetch(const Key& key) const;
    void prefetch_sample(const Key& key) const;
    bool find(const Key& key, FastSample& sample) const;
    void put(const Key& key, const FastSample& sample);

    uint64_t count() const {
        return std::min(next_.load(std::memory_order_relaxed), held_.load(std::memory_order_relaxed));
    }
    uint64_t bytes() const { return bytes_.load(std::memory_order_relaxed); }

  private:
    struct Slot;
    struct Table;
    /// A key's mark in the high bits, the number of its sample in the low ones; 0: none.
    using Entry = uint64_t;

    /// Tables at least double in size. Older ones are kept, because they may be in use; together they are at most as
    /// large as the last.
    static constexpr int kMostTables = 32;
    static constexpr uint64_t kMostChunks = 4096;
    static constexpr uint64_t kNotFull = ~uint64_t{0};

    // Read by every lookup.
    size_t values_, changes_;
    size_t slot_bytes_;
    uint64_t most_bytes_;
    uint64_t chunk_slots_;
    std::unique_ptr<Table> tables_[kMostTables];
    /// Each publishes the slots of a chunk: stored with release, loaded with acquire for a slot's address.
    std::unique_ptr<std::atomic<std::byte*>[]> chunks_;
    /// Publishes tables_[current_] with its entries (release), to `current()` (acquire).
    std::atomic<int> current_{-1};
    /// The number of slots once memory is full; all of them exist then. It changes once, before any number that depends
    /// on it is taken, so a thread that reads such a number from an entry (acquire) sees it too.
    std::atomic<uint64_t> held_{kNotFull};
    // Written with every sample.
    alignas(kCacheLine) std::atomic<uint64_t> next_{
        0};  ///< number of the next sample; its slot is there or full memory
    std::atomic<uint64_t> bytes_{0};
    /// Locks that are tried, never waited for: taken with acquire, released with release.
    std::atomic<bool> growing_{false}, making_chunk_{false};

    const Table* current() const;
    Slot* slot_at(uint32_t number) const;
    std::optional<uint32_t> take_number();
    uint32_t age_of(uint32_t number) const;
    std::atomic<Entry>& place_for(const Table& table, uint32_t mark) const;
    bool has_slot(uint64_t number);
    bool make_chunk(uint64_t chunk);
    bool reserve(uint64_t bytes);
    void read(const Slot& slot, FastSample& sample) const;
    void write(Slot& slot, const Key& key, const FastSample& sample) const;
    void grow();
};

}  // namespace rayleaf
