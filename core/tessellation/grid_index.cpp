#include "tessellation/grid_index.h"

#include <algorithm>

namespace rayleaf {

GridIndex::GridIndex(uint32_t capacity, uint32_t keys, bool as_table) : keys_(keys) {
    if (as_table) {
        table_ = ZeroedArray<std::atomic<uint32_t>>(keys);
        return;
    }
    set_count_ = static_cast<uint32_t>(set_bytes(capacity) / sizeof(Set)) + 1;
    sets_ = ZeroedArray<Set>(set_count_);
}

std::optional<uint32_t> GridIndex::insert(uint32_t key, uint32_t slot) {
    if (table_) {
        table_[key].store(slot + 1, std::memory_order_seq_cst);
        return std::nullopt;
    }
    const auto used = [](const std::atomic<uint64_t>* set) {
        return std::count_if(set, set + kWays,
                             [](const auto& way) { return way.load(std::memory_order_relaxed) != 0; });
    };
    std::atomic<uint64_t>*first = set_of(key, kFactors[0]), *second = set_of(key, kFactors[1]);
    std::atomic<uint64_t>* set = used(second) < used(first) ? second : first;
    const uint64_t entry = (uint64_t{key} + 1) << 32 | slot;
    for (int way = 0; way < kWays; ++way) {
        if (set[way].load(std::memory_order_relaxed) != 0) continue;
        set[way].store(entry, std::memory_order_seq_cst);
        return std::nullopt;
    }
    std::atomic<uint64_t>& way = set[next_way_++ % kWays];
    return static_cast<uint32_t>(way.exchange(entry, std::memory_order_seq_cst));
}

void GridIndex::remove(uint32_t key, uint32_t slot) {
    if (table_) {
        table_[key].store(0, std::memory_order_seq_cst);
        return;
    }
    const uint64_t entry = (uint64_t{key} + 1) << 32 | slot;
    for (const uint32_t factor : kFactors) {
        std::atomic<uint64_t>* set = set_of(key, factor);
        for (int way = 0; way < kWays; ++way)
            if (set[way].load(std::memory_order_relaxed) == entry) set[way].store(0, std::memory_order_seq_cst);
    }
}

uint64_t GridIndex::bytes() const {
    return table_ ? table_bytes(keys_) : set_count_ * sizeof(Set);
}

}  // namespace rayleaf
