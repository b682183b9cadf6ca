#include "tessellation/grid_pool.h"

#include <algorithm>

namespace rayleaf {
namespace {

/// So many slots are on their way out at a time, at most a share of all: each needs the rays under way to end first.
constexpr uint32_t kMostOnTheWayOut = 32, kLeastShareOnTheWayOut = 8;

/// What a slot costs beside itself and the index: mark, key, late miss, and its share of those on the way out.
constexpr uint64_t kTrackingPerSlot = sizeof(uint8_t) + 2 * sizeof(uint32_t) + 2;

/// A table may take this share of the budget.
constexpr uint64_t kTableShare = 4;

}  // namespace

GridIndex::GridIndex(uint32_t capacity, uint32_t keys, bool as_table) : keys_(keys) {
    if (as_table) {
        table_ = std::make_unique<std::atomic<uint32_t>[]>(keys);
        return;
    }
    set_count_ = static_cast<uint32_t>(capacity * kSetBytesPerSlot / sizeof(Set)) + 1;
    sets_ = std::make_unique<Set[]>(set_count_);
}

std::optional<uint32_t> GridIndex::insert(uint32_t key, uint32_t slot) {
    if (table_) {
        table_[key].store(slot + 1, std::memory_order_seq_cst);
        return std::nullopt;
    }
    std::atomic<uint64_t>* set = set_of(key);
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
    std::atomic<uint64_t>* set = set_of(key);
    const uint64_t entry = (uint64_t{key} + 1) << 32 | slot;
    for (int way = 0; way < kWays; ++way)
        if (set[way].load(std::memory_order_relaxed) == entry) set[way].store(0, std::memory_order_seq_cst);
}

uint64_t GridIndex::bytes() const {
    return table_ ? table_bytes(keys_) : set_count_ * sizeof(Set);
}

GridSlots::GridSlots(uint64_t budget, uint64_t slot_bytes, uint32_t keys) {
    const uint64_t table = GridIndex::table_bytes(keys);
    const bool as_table = table <= budget / kTableShare;
    const double per_slot =
        static_cast<double>(slot_bytes + kTrackingPerSlot) + (as_table ? 0.0 : GridIndex::kSetBytesPerSlot);
    const uint64_t for_slots = as_table ? budget - table : budget - std::min(budget, uint64_t{64});
    // More than one for each key would never be used, but for those on the way out.
    const uint64_t most = uint64_t{keys} + kMostOnTheWayOut;
    capacity_ = static_cast<uint32_t>(std::min(static_cast<uint64_t>(static_cast<double>(for_slots) / per_slot), most));
    if (capacity_ == 0) return;
    index_ = GridIndex(capacity_, keys, as_table);
    marks_ = std::make_unique<std::atomic<uint8_t>[]>(capacity_);
    missed_ = std::make_unique<std::atomic<uint32_t>[]>(capacity_);
    keys_.resize(capacity_);
}

std::optional<uint32_t> GridSlots::acquire(ReaderEpochs& epochs) {
    if (capacity_ == 0) return std::nullopt;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return std::nullopt;
    if (!free_.empty()) {
        const uint32_t slot = free_.back();
        free_.pop_back();
        return slot;
    }
    const uint32_t used = used_.load(std::memory_order_relaxed);
    if (used < capacity_) {
        used_.store(used + 1, std::memory_order_relaxed);
        return used;
    }
    make_room(epochs);
    if (retired_.empty() || retired_.front().stamp >= epochs.oldest()) return std::nullopt;
    const uint32_t slot = retired_.front().slot;
    retired_.pop_front();
    return slot;
}

bool GridSlots::publish(uint32_t key, uint32_t slot, ReaderEpochs& epochs) {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return false;
    if (index_.find(key) != GridIndex::kNone) return false;  // another thread was faster
    marks_[slot].store(0, std::memory_order_relaxed);
    keys_[slot] = key + 1;
    if (const std::optional<uint32_t> pushed_out = index_.insert(key, slot)) retire(*pushed_out, epochs);
    if (full()) make_room(epochs);
    return true;
}

void GridSlots::retire(uint32_t slot, ReaderEpochs& epochs) {
    keys_[slot] = 0;
    retired_.push_back({slot, epochs.advance()});
}

/// Sends slots on the way out until there are enough.
void GridSlots::make_room(ReaderEpochs& epochs) {
    const uint32_t wanted = std::min(kMostOnTheWayOut, std::max(1u, capacity_ / kLeastShareOnTheWayOut));
    for (uint32_t steps = 2 * capacity_; retired_.size() < wanted && steps > 0; --steps) {
        const uint32_t slot = hand_;
        hand_ = hand_ + 1 < capacity_ ? hand_ + 1 : 0;
        if (keys_[slot] == 0) continue;
        if (marks_[slot].load(std::memory_order_relaxed) != 0) {
            marks_[slot].store(0, std::memory_order_relaxed);
            continue;
        }
        index_.remove(keys_[slot] - 1, slot);
        retire(slot, epochs);
    }
}

bool GridSlots::missed_lately(uint32_t key) {
    const uint32_t place = static_cast<uint32_t>(uint64_t{key * 2654435769u} * capacity_ >> 32);
    if (missed_[place].load(std::memory_order_relaxed) == key + 1) return true;
    missed_[place].store(key + 1, std::memory_order_relaxed);
    return false;
}

uint64_t GridSlots::tracking_bytes() const {
    return capacity_ == 0 ? 0 : index_.bytes() + capacity_ * kTrackingPerSlot;
}

}  // namespace rayleaf
