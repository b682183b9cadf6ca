// Counts, over frames, the rays that cross cells too few of one frame's rays cross: so that a cache that is kept
// samples in the end what is used again and again (the rent-or-buy rule of online algorithms; Karlin et al.,
// Competitive Snoopy Caching, 1988).
//
// Idea: a table of counters without keys. The hash of a cell selects two of them, and its count is the smaller one (the
// count-min sketch of Cormode and Muthukrishnan, 2005). A count may be too large, where other cells share both
// counters, but never too small, up to kMostAdded a frame. Sums do not depend on the order in which threads add, and a
// frame sees the counts of earlier frames only. So answers depend neither on threads nor on the cache size, which
// does not include the table.
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

    /// Rays that crossed a cell in earlier frames. Thread-safe.
    uint32_t before(const CellKey& cell) const {
        if (!has_finished_) return 0;
        const Places places = places_of(cell);
        const std::array<uint16_t, kCounters>& finished = counters_.load(std::memory_order_acquire)->finished;
        return std::min(finished[places.first], finished[places.second]);
    }
    /// Counts one more ray of this frame. Thread-safe.
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
    /// From now on, the counts of this frame are those of an earlier one. No other thread may use the table meanwhile.
    /// If too many counters are in use, all are halved, so that cells that are not crossed again are forgotten.
    void finish_frame();

  private:
    /// 2 MB in all, which the system provides as they are used, and only where rays are counted.
    static constexpr uint64_t kCounters = uint64_t{1} << 19;
    /// The most rays of a frame that one counter counts; far more than any cell needs. Threads may exceed it by a few
    /// before they see that it is reached, which finish_frame() corrects: hence half of what sixteen bits hold.
    static constexpr uint16_t kMostAdded = uint16_t{1} << 15;
    struct Counters {
        std::array<uint16_t, kCounters> added, finished;
    };
    struct Places {
        size_t first, second;
    };

    /// Publishes the counters, all zero: stored with release by the first that made them, loaded with acquire.
    std::atomic<Counters*> counters_{nullptr};
    bool has_finished_ = false;  ///< a frame in which rays were counted has ended has ended

    Counters* make_counters();
    static Places places_of(const CellKey& cell);
};

}  // namespace rayleaf
