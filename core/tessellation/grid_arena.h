// The memory of the geometry cache: units of equal size. By demand, a unit holds one fine grid, or two in steps
// (tessellation/step_grid.h), or sixteen medium grids, or one part of a split subpatch.
//
// Lookups take no lock (tessellation/grid_index.h). Changes are made under a lock that is tried, never waited for: a
// thread that finds it taken does without. The clock algorithm evicts: a hand goes round the units of all kinds and
// takes the grids that were not used since it last passed. Medium and fine grids take about as many bytes per vertex,
// so one clock is fair to both, and memory goes where rays are.
#pragma once

#include "base/cache_line.h"
#include "base/large_memory.h"
#include "base/zeroed_array.h"
#include "tessellation/grid.h"
#include "tessellation/grid_index.h"
#include "tessellation/readers.h"
#include "tessellation/slot_mask.h"
#include "tessellation/snapped_grid.h"
#include "tessellation/step_grid.h"

#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace rayleaf {

// What threads write often has lines of its own. NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding)
class GridArena {
  public:
    static constexpr uint32_t kNone = GridIndex::kNone;
    enum class Kind : uint8_t { Medium, Steps, Fine, Part };
    static constexpr int kKinds = 4;
    /// Grids of a kind in a unit; the rest is not used. NOLINTBEGIN(bugprone-sizeof-expression)
    static constexpr uint32_t kMediumSlots = sizeof(Grid) / sizeof(MediumGrid);
    // NOLINTEND(bugprone-sizeof-expression)
    static constexpr uint32_t kStepSlots = 2;
    static constexpr uint32_t slots_of(Kind kind) {
        constexpr uint32_t kCounts[kKinds] = {kMediumSlots, kStepSlots, 1, 1};
        return kCounts[static_cast<int>(kind)];
    }
    /// Slots of a unit are numbered for the smallest grids.
    static constexpr uint32_t kSlots = kMediumSlots;
    static_assert(kSlots <= SlotMask::kMost);
    /// Subpatches are numbered below this.
    static constexpr uint32_t kMostSubpatches = 1u << 31;

    /// Makes as many units as fit `budget` with their bookkeeping.
    GridArena(uint64_t budget, uint32_t subpatches);

    /// A part of a split subpatch. It is found by its hash; the key distinguishes parts with equal hashes.
    struct PartKey {
        uint64_t key;
        uint32_t hash;

        PartKey(uint32_t subpatch, const GridPart& part);
    };

    bool empty() const { return unit_count_ == 0; }
    /// Whether all memory is in use.
    bool full() const { return used_.load(std::memory_order_relaxed) >= unit_count_; }
    /// The slot of a subpatch's grid, fine or medium of any kind, and marks it as used; kNone if there is
    /// none.
    uint32_t find(Kind kind, uint32_t subpatch) const {
        if (unit_count_ == 0) return kNone;
        const uint32_t slot = index_.find(key(kind, subpatch));
        if (slot != kNone) mark(slot);
        return slot;
    }
    /// The same for a part.
    uint32_t find(const PartKey& part) const {
        if (unit_count_ == 0) return kNone;
        const uint32_t slot = part_index_.find(part.hash);
        if (slot == kNone || part_keys_[slot / kSlots].load(std::memory_order_relaxed) != part.key) return kNone;
        mark(slot);
        return slot;
    }
    /// The kind of the grid found in a slot.
    Kind kind(uint32_t slot) const { return kind_of(slot / kSlots); }
    Grid& fine(uint32_t slot) const { return memory(slot).fine; }
    StepGrid& steps(uint32_t slot) const { return memory(slot).steps[slot % kSlots]; }
    MediumGrid& medium(uint32_t slot) const { return memory(slot).medium[slot % kSlots]; }

    /// A slot that no other thread sees, for the caller to fill; empty if none is free now.
    std::optional<uint32_t> acquire(Kind kind, ReaderEpochs& epochs);
    /// Makes a filled slot visible. False if that is not possible now: the slot stays with the caller.
    bool publish(Kind kind, uint32_t subpatch, uint32_t slot, ReaderEpochs& epochs);
    bool publish(const PartKey& part, uint32_t slot, ReaderEpochs& epochs);
    /// While memory is short: whether a grid was missed before, not long ago. Only such grids get a slot.
    bool missed_lately(Kind kind, uint32_t subpatch) { return missed_lately(key(kind, subpatch)); }
    bool missed_lately(const PartKey& part) { return missed_lately(part.hash); }

    uint64_t bytes(Kind kind) const {
        return units_of_[static_cast<int>(kind)].load(std::memory_order_relaxed) * sizeof(Memory);
    }
    /// Memory of all units ever used, and of their bookkeeping.
    uint64_t bytes() const;

  private:
    union alignas(kCacheLine) Memory {
        Grid fine;
        StepGrid steps[kStepSlots];
        MediumGrid medium[kMediumSlots];
    };
    static_assert(sizeof(Memory) <= sizeof(Grid) + alignof(Grid));
    struct Unit {
        uint64_t stamp = 0;  ///< of the slots that are leaving
        SlotMask free;       ///< slots that may be handed out
        SlotMask leaving;    ///< slots that readers may still see; the unit waits in `leaving_` then
        uint8_t listed = 0;  ///< a bit for each kind in whose `with_room_` it is
    };

    uint32_t unit_count_ = 0;
    GridIndex index_, part_index_;
    LargeMemory memory_;
    /// By unit. Published by the index with the grids of the unit.
    ZeroedArray<std::atomic<Kind>> kinds_;
    ZeroedArray<std::atomic<uint8_t>>
        marks_;  ///< by slot: used since the clock's hand passed; a hint, which publishes nothing
    /// By unit, of parts. Published by the index with the part.
    ZeroedArray<std::atomic<uint64_t>> part_keys_;
    ZeroedArray<std::atomic<uint32_t>> missed_;  ///< key + 1 of recent misses, by hash; a hint
    ZeroedArray<uint32_t> owners_;               ///< by slot: key + 1 of those that are visible, else 0
    ZeroedArray<Unit> units_;
    // Changed under the lock, while other threads look up.
    alignas(kCacheLine) std::mutex mutex_;
    std::atomic<bool> has_parts_{false};       ///< or had some; for statistics
    std::deque<uint32_t> leaving_;             ///< units, in the order of their stamps
    std::vector<uint32_t> free_;               ///< units that hold nothing
    std::vector<uint32_t> with_room_[kKinds];  ///< units that hold grids of a kind, some without room
    std::atomic<uint32_t> used_{0};            ///< units handed out for the first time so far; a counter
    std::atomic<uint32_t> units_of_[kKinds]{};
    uint32_t hand_ = 0;

    Memory& memory(uint32_t slot) const { return reinterpret_cast<Memory*>(memory_.get())[slot / kSlots]; }
    static uint32_t key(Kind kind, uint32_t subpatch) {
        return 2 * subpatch + (kind == Kind::Fine || kind == Kind::Steps ? 1 : 0);
    }
    void mark(uint32_t slot) const {
        if (marks_[slot].load(std::memory_order_relaxed) == 0) marks_[slot].store(1, std::memory_order_relaxed);
    }
    GridIndex& index_of(uint32_t unit) { return kind_of(unit) == Kind::Part ? part_index_ : index_; }
    bool publish_in(GridIndex& index, uint32_t wanted, uint32_t slot, ReaderEpochs& epochs);
    bool missed_lately(uint32_t wanted);
    static uint64_t tracking_per_unit();
    std::optional<uint32_t> take_unit(Kind kind);
    std::optional<uint32_t> take(Kind kind);
    void list(uint32_t number);
    Kind kind_of(uint32_t unit) const { return kinds_[unit].load(std::memory_order_relaxed); }
    static constexpr uint8_t bit_of(Kind kind) { return static_cast<uint8_t>(1u << static_cast<int>(kind)); }
    SlotMask unused_slots(uint32_t unit);
    void retire(uint32_t unit, const SlotMask& slots, ReaderEpochs& epochs);
    void make_room(ReaderEpochs& epochs);
    void reclaim(const ReaderEpochs& epochs);
};

}  // namespace rayleaf
