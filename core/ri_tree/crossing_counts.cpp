#include "ri_tree/crossing_counts.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace rayleaf {
namespace {

/// With a quarter of the counters in use one cell in sixteen is mistaken for another that was crossed.
constexpr uint64_t kMostUsed = 4;

uint64_t mixed(uint64_t h) {  // Stafford's variant 13 of MurmurHash3's finalizer
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    return h ^ (h >> 31);
}

}  // namespace

CrossingCounts::Places CrossingCounts::places_of(const CellKey& cell) {
    const uint64_t low = cell.index[0] | uint64_t{cell.index[1]} << 32;
    const uint64_t high = cell.index[2] | uint64_t{cell.index[3]} << 32;
    const uint64_t which = (uint64_t{cell.direction} << 8 | cell.depth) * 0x9e3779b97f4a7c15u;
    const uint64_t hash = mixed(mixed(low + which) ^ high);
    return {static_cast<size_t>(hash & (kCounters - 1)), static_cast<size_t>(hash >> 32 & (kCounters - 1))};
}

CrossingCounts::~CrossingCounts() {
    std::free(counters_.load(std::memory_order_relaxed));
}

/// Null if there is no memory.
CrossingCounts::Counter* CrossingCounts::make_counters() {
    // All bits zero is a counter at zero; the system gives such pages without touching them.
    auto* made = static_cast<Counter*>(std::calloc(kCounters, sizeof(Counter)));
    Counter* before = nullptr;
    if (counters_.compare_exchange_strong(before, made, std::memory_order_acq_rel)) return made;
    std::free(made);
    return before;
}

void CrossingCounts::finish_frame() {
    Counter* counters = counters_.load(std::memory_order_acquire);
    if (!counters) return;
    has_finished_ = true;
    constexpr uint32_t kMost = std::numeric_limits<uint16_t>::max();
    uint64_t used = 0;
    for (uint64_t i = 0; i < kCounters; ++i) {
        Counter& counter = counters[i];
        const uint32_t sum = counter.finished + uint32_t{counter.added.exchange(0, std::memory_order_relaxed)};
        counter.finished = static_cast<uint16_t>(std::min(sum, kMost));
        used += counter.finished > 0 ? 1 : 0;
    }
    while (used * kMostUsed > kCounters) {
        used = 0;
        for (uint64_t i = 0; i < kCounters; ++i) {
            counters[i].finished = static_cast<uint16_t>(counters[i].finished / 2);
            used += counters[i].finished > 0 ? 1 : 0;
        }
    }
}

}  // namespace rayleaf
