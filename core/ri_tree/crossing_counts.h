// How many rays of earlier frames crossed the cells that one frame's rays do not pay for: so that a cache that is kept
// buys in the end what is used again and again (the rent-or-buy rule of online algorithms; Karlin et al., Competitive
// Snoopy Caching, 1988).
//
// Idea: a table of counters without keys. A cell adds to two of them, told by its hash, and its count is the smaller
// one (the count-min sketch of Cormode and Muthukrishnan, 2005): it may be too large, where others share both, never
// too small. Sums do not depend on the order in which threads add, and what is added is only seen by the next frame: so
// answers depend neither on threads, nor on the size of the cache, which the table is no part of.
#pragma once

#include "ri_tree/line_space.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>

namespace rayleaf {

class CrossingCounts {
  public:
    CrossingCounts() = default;
    ~CrossingCounts();
    CrossingCounts(const CrossingCounts&) = delete;
    CrossingCounts& operator=(const CrossingCounts&) = delete;

    /// Rays that crossed a cell in frames before this one. Thread-safe.
    uint32_t before(const CellKey& cell) const {
        if (!has_finished_) return 0;
        const Counter* counters = counters_.load(std::memory_order_acquire);
        const Places places = places_of(cell);
        return std::min(counters[places.first].finished, counters[places.second].finished);
    }
    /// One more ray in this frame. Thread-safe.
    void add(const CellKey& cell) {
        Counter* counters = counters_.load(std::memory_order_acquire);
        if (!counters) counters = make_counters();
        if (!counters) return;
        const Places places = places_of(cell);
        counters[places.first].added.fetch_add(1, std::memory_order_relaxed);
        counters[places.second].added.fetch_add(1, std::memory_order_relaxed);
    }
    /// What was added counts from now on. While no other thread does anything. Where too many counters are in use, all
    /// are halved: what is not crossed again is forgotten.
    void finish_frame();

  private:
    /// 2 MB together, taken from the system as they are used, and only where rays are counted.
    static constexpr uint64_t kCounters = uint64_t{1} << 19;
    struct Counter {
        std::atomic<uint16_t> added;
        uint16_t finished;
    };
    struct Places {
        size_t first, second;
    };

    std::atomic<Counter*> counters_{nullptr};
    bool has_finished_ = false;  ///< a frame in which rays were counted

    Counter* make_counters();

    static Places places_of(const CellKey& cell);
};

}  // namespace rayleaf
