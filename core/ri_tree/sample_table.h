// Samples shared by the cells that meet in a lattice point: a table that may forget.
//
// Samples are pure functions of their points, so one that was dropped, or that another thread is just writing, is
// traced again. Nobody waits: a place that is busy counts as one without the sample.
#pragma once

#include "ri_tree/fast_sample.h"

#include <atomic>
#include <cstdint>
#include <memory>

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
        uint64_t hash = 0;
    };
    static Key key_of(const LatticePoint& point);

    /// Says that the key's sample will be looked for soon: first of all keys, then `prefetch_sample` of all.
    void prefetch(const Key& key) const;
    void prefetch_sample(const Key& key) const;
    bool find(const Key& key, FastSample& sample) const;
    void put(const Key& key, const FastSample& sample);

    uint64_t count() const { return count_.load(std::memory_order_relaxed); }
    uint64_t bytes() const { return bytes_.load(std::memory_order_relaxed); }

  private:
    struct Slot;
    struct Table;

    /// Tables at least double in size. Older ones are kept, for they may be in use; together they are at most as large
    /// as the last.
    static constexpr int kMostTables = 32;

    size_t values_, changes_;
    size_t slot_bytes_;
    uint64_t most_bytes_;
    std::unique_ptr<Table> tables_[kMostTables];
    std::atomic<int> current_{-1};
    std::atomic<bool> growing_{false};
    std::atomic<uint64_t> count_{0}, bytes_{0};

    Slot* slot_at(const Table& table, uint64_t index) const;
    bool put_in(Table& table, const Key& key, const FastSample& sample);
    void read(const Slot& slot, FastSample& sample) const;
    void write(Slot& slot, const FastSample& sample) const;
    uint64_t copy(const Table& from, Table& to);
    void grow();
};

}  // namespace rayleaf
