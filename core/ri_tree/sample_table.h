// Samples shared by the cells that meet in a lattice point: a table that may forget.
//
// Samples are pure functions of their points, so one that was dropped, or that another thread is just reading or
// writing, is traced again. Nobody waits: a sample that is busy counts as none.
//
// Samples lie in chunks, in the order in which they came; a table of places tells where. Only that one grows. Once
// memory is at its limit the oldest sample makes way: where the view moves on, what was just sampled is what
// neighbouring cells will ask for. (Any sample making way, told by chance, an orbit traced twice as many.)
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
    /// Holds at most `most_bytes`, and starts small.
    SampleTable(OutputKind kind, SampleContents contents, uint64_t most_bytes);
    ~SampleTable();
    SampleTable(const SampleTable&) = delete;
    SampleTable& operator=(const SampleTable&) = delete;

    /// A lattice point, and where to look for it.
    struct Key {
        LatticePoint point;
        uint32_t mark = 0;
    };
    static Key key_of(const LatticePoint& point);

    /// Says that the key's sample will be looked for soon: first of all keys, then `prefetch_sample` of all.
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
    /// A key's mark above the number of its sample; 0: none.
    using Entry = uint64_t;

    /// Tables at least double in size. Older ones are kept, for they may be in use; together they are at most as large
    /// as the last.
    static constexpr int kMostTables = 32;
    static constexpr uint64_t kMostChunks = 4096;
    static constexpr uint64_t kNotFull = ~uint64_t{0};

    // Read by whoever looks for a sample.
    size_t values_, changes_;
    size_t slot_bytes_;
    uint64_t most_bytes_;
    uint64_t chunk_slots_;
    std::unique_ptr<Table> tables_[kMostTables];
    /// Each publishes the slots of a chunk (release), to who reads it for a slot's address (acquire).
    std::unique_ptr<std::atomic<std::byte*>[]> chunks_;
    /// Publishes tables_[current_] with what it tells (release), to `current()` (acquire).
    std::atomic<int> current_{-1};
    /// What memory holds, once it is full: so many slots, all of them there. Changes once, before any number that it
    /// concerns is taken, so whoever has such a number by an entry (acquire) sees it too.
    std::atomic<uint64_t> held_{kNotFull};
    // Written with every sample.
    alignas(kCacheLine) std::atomic<uint64_t> next_{
        0};  ///< number of the next sample; its slot is there or full memory
    std::atomic<uint64_t> bytes_{0};
    /// Each taken by one thread at a time (acquire) that lets it go (release): what it made is seen by the next.
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
