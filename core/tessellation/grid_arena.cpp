#include "tessellation/grid_arena.h"

#include "base/hash64.h"
#include "tessellation/level.h"

#include <algorithm>
#include <thread>

namespace rayleaf {
namespace {

/// This many units, or a share of all, are free or leaving at a time: a unit is free once the current rays have ended.
constexpr size_t kMostOnTheWayOut = 16, kLeastShareOnTheWayOut = 8;

/// A table may take one part in this many of the budget.
constexpr uint64_t kTableShare = 4;

/// Recent misses remembered per unit.
constexpr uint32_t kMissesPerUnit = 4;

/// Bytes of a part in the index: set_bytes, rounded up.
constexpr uint64_t kPartEntry = 9;

/// A unit in which less than one grid in this many is in use is emptied.
constexpr uint32_t kLeastShareUsed = 4;

/// The number of parts of a subpatch, of all levels.
constexpr uint64_t kMostParts = [] {
    uint64_t sum = 0;
    for (int level = kFine + 1; level <= kFinestLevel; ++level)
        sum += static_cast<uint64_t>(quads_along(level - kFine) * quads_along(level - kFine));
    return sum;
}();

}  // namespace

GridArena::PartKey::PartKey(uint32_t subpatch, const GridPart& part)
    : key((uint64_t{subpatch} * (kFinestLevel + 1) + static_cast<uint64_t>(part.level)) * (kMostParts + 1) +
          part.number()) {
    hash = static_cast<uint32_t>(hash64(key * kHashStep) >> 33);
}

uint64_t GridArena::tracking_per_unit() {
    return kSlots * (sizeof(uint8_t) + sizeof(uint32_t)) + sizeof(Unit) + sizeof(Kind) + sizeof(uint64_t) +
           (2 + kKinds + kMissesPerUnit) * sizeof(uint32_t);
}

GridArena::GridArena(uint64_t budget, uint32_t subpatches) {
    const uint64_t table = GridIndex::table_bytes(2 * subpatches);
    const bool as_table = table <= budget / kTableShare;
    const uint64_t sets = as_table ? 0 : GridIndex::set_bytes(kSlots);
    constexpr uint64_t kSet = 64;  // of an index of sets, beyond what units take
    const uint64_t fixed = (as_table ? table : kSet) + kSet;
    const uint64_t for_units = budget - std::min(budget, fixed);
    const uint64_t threads = uint64_t{std::thread::hardware_concurrency()} + 1;
    // More would never be used, except by grids that are leaving and slots that threads hold.
    const uint64_t most =
        uint64_t{subpatches} * (1 + kMostParts) + subpatches / kSlots + kMostOnTheWayOut + 2 * threads;
    constexpr uint64_t kNumbered = (uint64_t{1} << 32) / kSlots - 1;
    const uint64_t fitting = for_units / (sizeof(Memory) + tracking_per_unit() + sets + kPartEntry);
    unit_count_ = static_cast<uint32_t>(std::min({fitting, most, kNumbered}));
    if (unit_count_ == 0) return;
    const uint32_t slots = unit_count_ * kSlots;
    // A few grids should not take a whole large page.
    memory_ = large_memory(unit_count_ * sizeof(Memory), kLargePage);
    if (!memory_) throw std::bad_alloc();
    index_ = GridIndex(slots, 2 * subpatches, as_table);
    part_index_ = GridIndex(unit_count_, 0, false);
    part_keys_ = ZeroedArray<std::atomic<uint64_t>>(unit_count_);
    kinds_ = ZeroedArray<std::atomic<Kind>>(unit_count_);
    marks_ = ZeroedArray<std::atomic<uint8_t>>(slots);
    missed_ = ZeroedArray<std::atomic<uint32_t>>(unit_count_ * kMissesPerUnit);
    owners_ = ZeroedArray<uint32_t>(slots);
    units_ = ZeroedArray<Unit>(unit_count_);
}

/// Takes an empty unit for grids of a kind.
std::optional<uint32_t> GridArena::take_unit(Kind kind) {
    const uint32_t used = used_.load(std::memory_order_relaxed);
    uint32_t unit = used;
    if (!free_.empty()) {
        unit = free_.back();
        free_.pop_back();
    } else if (used < unit_count_) {
        used_.store(used + 1, std::memory_order_relaxed);
    } else {
        return std::nullopt;
    }
    kinds_[unit].store(kind, std::memory_order_relaxed);
    units_of_[static_cast<int>(kind)].fetch_add(1, std::memory_order_relaxed);
    return unit;
}

/// Lists a unit that has free slots.
void GridArena::list(uint32_t number) {
    const Kind kind = kind_of(number);
    Unit& unit = units_[number];
    if (unit.free.empty() || (unit.listed & bit_of(kind)) != 0) return;
    unit.listed |= bit_of(kind);
    with_room_[static_cast<int>(kind)].push_back(number);
}

std::optional<uint32_t> GridArena::take(Kind kind) {
    std::vector<uint32_t>& with_room = with_room_[static_cast<int>(kind)];
    for (; !with_room.empty(); with_room.pop_back()) {
        const uint32_t number = with_room.back();
        Unit& unit = units_[number];
        if (unit.free.empty() || kind_of(number) != kind) {
            unit.listed &= static_cast<uint8_t>(~bit_of(kind));
            continue;
        }
        const uint32_t slot = unit.free.lowest();
        unit.free.remove(slot);
        return number * kSlots + slot;
    }
    const std::optional<uint32_t> taken = take_unit(kind);
    if (!taken) return std::nullopt;
    Unit& unit = units_[*taken];
    unit.free = SlotMask::first(slots_of(kind));
    unit.free.remove(0);
    list(*taken);
    return *taken * kSlots;
}

std::optional<uint32_t> GridArena::acquire(Kind kind, ReaderEpochs& epochs) {
    if (unit_count_ == 0) return std::nullopt;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return std::nullopt;
    if (const std::optional<uint32_t> slot = take(kind)) return slot;
    make_room(epochs);
    reclaim(epochs);
    return take(kind);
}

bool GridArena::publish(Kind kind, uint32_t subpatch, uint32_t slot, ReaderEpochs& epochs) {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    return lock && publish_in(index_, key(kind, subpatch), slot, epochs);
}

bool GridArena::publish(const PartKey& part, uint32_t slot, ReaderEpochs& epochs) {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return false;
    has_parts_.store(true, std::memory_order_relaxed);
    part_keys_[slot / kSlots].store(part.key, std::memory_order_relaxed);  // published by the index
    return publish_in(part_index_, part.hash, slot, epochs);
}

bool GridArena::publish_in(GridIndex& index, uint32_t wanted, uint32_t slot, ReaderEpochs& epochs) {
    if (index.find(wanted) != kNone) return false;  // another thread was first, or a part has the same hash
    marks_[slot].store(0, std::memory_order_relaxed);
    owners_[slot] = wanted + 1;
    if (const std::optional<uint32_t> out = index.insert(wanted, slot)) {
        owners_[*out] = 0;
        const uint32_t unit = *out / kSlots;
        retire(unit, SlotMask::one(*out % kSlots), epochs);
    }
    if (full()) make_room(epochs);
    return true;
}

void GridArena::retire(uint32_t unit, const SlotMask& slots, ReaderEpochs& epochs) {
    Unit& leaving = units_[unit];
    if (leaving.leaving.empty()) leaving_.push_back(unit);
    leaving.leaving.add(slots);
    leaving.stamp = epochs.advance();
}

/// The grids that the clock's hand evicts from a unit: those without marks, or all if few have one. Clears the marks.
SlotMask GridArena::unused_slots(uint32_t unit) {
    SlotMask held, unused;
    uint32_t used = 0;
    const uint32_t count = slots_of(kind_of(unit));
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t slot = unit * kSlots + i;
        if (owners_[slot] == 0) continue;
        held.add(i);
        if (marks_[slot].load(std::memory_order_relaxed) == 0)
            unused.add(i);
        else
            ++used;
        marks_[slot].store(0, std::memory_order_relaxed);
    }
    return used < count / kLeastShareUsed ? held : unused;
}

/// Evicts grids until enough are leaving.
void GridArena::make_room(ReaderEpochs& epochs) {
    const size_t wanted = std::min(kMostOnTheWayOut, std::max(size_t{1}, unit_count_ / kLeastShareOnTheWayOut));
    for (uint32_t steps = 2 * unit_count_; leaving_.size() + free_.size() < wanted && steps > 0; --steps) {
        const uint32_t number = hand_;
        hand_ = hand_ + 1 < unit_count_ ? hand_ + 1 : 0;
        if (!units_[number].leaving.empty()) continue;
        const SlotMask out = unused_slots(number);
        if (out.empty()) continue;
        for (uint32_t i = 0; i < slots_of(kind_of(number)); ++i) {
            uint32_t& owner = owners_[number * kSlots + i];
            if (!out.has(i) || owner == 0) continue;
            index_of(number).remove(owner - 1, number * kSlots + i);
            owner = 0;
        }
        retire(number, out, epochs);
    }
}

/// Frees the slots that no reader can see any more.
void GridArena::reclaim(const ReaderEpochs& epochs) {
    if (leaving_.empty()) return;
    const uint64_t oldest = epochs.oldest();
    for (; !leaving_.empty() && units_[leaving_.front()].stamp < oldest; leaving_.pop_front()) {
        const uint32_t number = leaving_.front();
        Unit& unit = units_[number];
        unit.free.add(unit.leaving);
        unit.leaving = {};
        const Kind kind = kind_of(number);
        if (unit.free == SlotMask::first(slots_of(kind))) {
            unit.free = {};
            free_.push_back(number);
            units_of_[static_cast<int>(kind)].fetch_sub(1, std::memory_order_relaxed);
        } else {
            list(number);
        }
    }
}

bool GridArena::missed_lately(uint32_t key) {
    const uint32_t wanted = key + 1, places = unit_count_ * kMissesPerUnit;
    const auto place = static_cast<uint32_t>(uint64_t{wanted * 2654435769u} * places >> 32);
    if (missed_[place].load(std::memory_order_relaxed) == wanted) return true;
    missed_[place].store(wanted, std::memory_order_relaxed);
    return false;
}

uint64_t GridArena::bytes() const {
    if (unit_count_ == 0) return 0;
    const uint64_t parts = has_parts_.load(std::memory_order_relaxed) ? part_index_.bytes() : 0;
    return index_.bytes() + parts + used_.load(std::memory_order_relaxed) * (tracking_per_unit() + sizeof(Memory));
}

}  // namespace rayleaf
