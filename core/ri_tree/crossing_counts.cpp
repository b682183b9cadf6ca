#include "ri_tree/crossing_counts.h"

#include "base/hash64.h"

#include <cstdlib>
#include <limits>

namespace rayleaf {
namespace {

/// With a quarter of the counters in use, one cell in sixteen is mistaken for one that was crossed.
constexpr uint64_t kMostUsed = 4;

}  // namespace

CrossingCounts::Places CrossingCounts::places_of(const CellKey& cell) {
    const uint64_t low = cell.index[0] | uint64_t{cell.index[1]} << 32;
    const uint64_t high = cell.index[2] | uint64_t{cell.index[3]} << 32;
    const uint64_t which = (uint64_t{cell.direction} << 8 | cell.depth) * kHashStep;
    const uint64_t hash = hash64(hash64(low + which) ^ high);
    return {static_cast<size_t>(hash & (kCounters - 1)), static_cast<size_t>(hash >> 32 & (kCounters - 1))};
}

CrossingCounts::~CrossingCounts() {
    std::free(counters_.load(std::memory_order_relaxed));
}

/// Null if there is no memory.
CrossingCounts::Counters* CrossingCounts::make_counters() {
    // Counters start at all bits zero; the system provides such pages without touching them.
    auto* made = static_cast<Counters*>(std::calloc(1, sizeof(Counters)));
    Counters* before = nullptr;
    if (counters_.compare_exchange_strong(before, made, std::memory_order_acq_rel)) return made;
    std::free(made);
    return before;
}

void CrossingCounts::finish_frame() {
    Counters* counters = counters_.load(std::memory_order_acquire);
    if (!counters) return;
    has_finished_ = true;
    // Arithmetic in sixteen bits, a block at a time, so that compilers vectorize the loop.
    constexpr uint64_t kAtOnce = 1024;
    uint64_t used = 0;
    for (uint64_t first = 0; first < kCounters; first += kAtOnce) {
        uint16_t *finished = &counters->finished[first], *added = &counters->added[first];
        uint16_t used_here = 0;
        for (uint64_t i = 0; i < kAtOnce; ++i) {
            const uint16_t more = std::min(added[i], kMostAdded);
            const auto sum = static_cast<uint16_t>(finished[i] + more);
            finished[i] = sum < more ? std::numeric_limits<uint16_t>::max() : sum;
            added[i] = 0;
            used_here = static_cast<uint16_t>(used_here + (finished[i] != 0 ? 1 : 0));
        }
        used += used_here;
    }
    while (used * kMostUsed > kCounters) {
        used = 0;
        for (uint16_t& count : counters->finished) {
            count = static_cast<uint16_t>(count / 2);
            used += count > 0 ? 1 : 0;
        }
    }
}

}  // namespace rayleaf
