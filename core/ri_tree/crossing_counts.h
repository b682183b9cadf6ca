// How many rays of earlier frames crossed the cells that one frame's rays do not pay for: so that a cache that is kept
// buys in the end what is used again and again (the rent-or-buy rule of online algorithms; Karlin et al., Competitive
// Snoopy Caching, 1988).
//
// Idea: a table of counters without keys. A cell adds to two of them, told by its hash, and its count is the smaller
// one (the count-min sketch of Cormode and Muthukrishnan, 2005): it may be too large, where others share both, never
// too small, up to kMostAdded a frame. Sums do not depend on the order in which threads add, and what is added is only
// seen by the next frame: so answers depend neither on threads, nor on the size of the cache, which the table is no
// part of.
#pragma once

#include "ri_tree/line_space.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>

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
        const Places places = places_of(cell);
        const std::array<uint16_t, kCounters>& finished = counters_.load(std::memory_order_acquire)->finished;
        return std::min(finished[places.first], finished[places.second]);
    }
    /// One more ray in this frame. Thread-safe.
    void add(const CellKey& cell) {
        Counters* counters = counters_.load(std::memory_order_acquire);
        if (!counters) counters = make_counters();
        if (!counters) return;
        const Places places = places_of(cell);
        for (const size_t place : {places.first, places.second}) {
            const std::atomic_ref counter(counters->added[place]);
            if (counter.load(std::memory_order_relaxed) < kMostAdded) counter.fetch_add(1, std::memory_order_relaxed);
        }
    }
    /// What was added counts from now on. While no other thread does anything. Where too many counters are in use, all
    /// are halved: what is not crossed again is forgotten.
    void finish_frame();

  private:
    /// 2 MB together, taken from the system as they are used, and only where rays are counted.
    static constexpr uint64_t kCounters = uint64_t{1} << 19;
    /// Rays of a frame that are counted in one place; far more than any cell needs. Threads may add a few beyond it
    /// before they see that it is reached, which finish_frame() takes back: hence half of what sixteen bits hold.
    static constexpr uint16_t kMostAdded = uint16_t{1} << 15;
    struct Counters {
        std::array<uint16_t, kCounters> added, finished;
    };
    struct Places {
        size_t first, second;
    };

    /// Publishes the counters, all zero (release, by who made them first), to who counts in them (acquire).
    std::atomic<Counters*> counters_{nullptr};
    bool has_finished_ = false;  ///< a frame in which rays were counted

    Counters* make_counters();
    static Places places_of(const CellKey& cell);
};

}  // namespace rayleaf
