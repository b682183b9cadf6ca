#include "ri_tree/sample_table.h"

#include "base/large_memory.h"

#include <algorithm>
#include <cstring>
#include <new>

namespace rayleaf {
namespace {

constexpr uint64_t kFirstSlots = 1024;
/// A sample is in one of so many neighbouring slots.
constexpr uint64_t kProbes = 4;
/// From so many bytes on a table is in large pages: its samples lie scattered, and use them all.
constexpr uint64_t kLargeTable = kLargePage;
constexpr size_t kCacheLine = 64;
/// The table grows when it is filled by more than 5/8, to four times its size, or where there is no room for that, to
/// twice its size.
constexpr uint64_t kGrowth = 4, kFullNumerator = 5, kFullDenominator = 8;

uint64_t mixed(uint64_t h) {  // Stafford's variant 13 of MurmurHash3's finalizer
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    return h ^ (h >> 31);
}

/// Marks of slots. All others: upper bits of the hash of what is there.
constexpr uint32_t kEmpty = 0, kBusy = 1;

uint32_t mark_of(uint64_t hash) {
    return std::max(static_cast<uint32_t>(hash >> 32), kBusy + 1);
}

uint64_t hash_of(const LatticePoint& point) {
    const uint64_t low = point.place[0] | uint64_t{point.place[1]} << 32;
    const uint64_t high = point.place[2] | uint64_t{point.place[3]} << 32;
    return mixed(mixed(low + point.direction) ^ high);
}

}  // namespace

/// Followed by the values, then their changes.
struct SampleTable::Slot {
    LatticePoint point;
    SampleClass sample_class;

    float* numbers() { return reinterpret_cast<float*>(this + 1); }
    const float* numbers() const { return reinterpret_cast<const float*>(this + 1); }
};

/// What is in a slot is told by its mark, in an array of their own: most searches are over after looking there.
struct SampleTable::Table {
    uint64_t slots = 0;
    std::atomic<uint64_t> filled{0};
    std::unique_ptr<std::atomic<uint32_t>[]> marks;
    LargeMemory memory;

    uint64_t index(uint64_t number) const { return number & (slots - 1); }
};

SampleTable::SampleTable(OutputKind kind, SampleContents contents, uint64_t most_bytes)
    : values_(static_cast<size_t>(sample_value_count(kind))),
      changes_(contents == SampleContents::Values ? 0 : values_ * kLineAxes),
      slot_bytes_(sizeof(Slot) + (values_ + changes_) * sizeof(float)),
      most_bytes_(most_bytes) {}

SampleTable::~SampleTable() = default;

SampleTable::Slot* SampleTable::slot_at(const Table& table, uint64_t index) const {
    return std::launder(reinterpret_cast<Slot*>(table.memory.get() + index * slot_bytes_));
}

void SampleTable::read(const Slot& slot, FastSample& sample) const {
    sample.sample_class = slot.sample_class;
    if (slot.sample_class.is_miss()) return;
    std::memcpy(sample.values.data(), slot.numbers(), values_ * sizeof(float));
    std::memcpy(sample.changes.data(), slot.numbers() + values_, changes_ * sizeof(float));
}

void SampleTable::write(Slot& slot, const FastSample& sample) const {
    slot.sample_class = sample.sample_class;
    if (sample.sample_class.is_miss()) return;
    std::memcpy(slot.numbers(), sample.values.data(), values_ * sizeof(float));
    std::memcpy(slot.numbers() + values_, sample.changes.data(), changes_ * sizeof(float));
}

SampleTable::Key SampleTable::key_of(const LatticePoint& point) {
    return {point, hash_of(point)};
}

void SampleTable::prefetch(const Key& key) const {
    const int current = current_.load(std::memory_order_acquire);
    if (current < 0) return;
    const Table& table = *tables_[current];
    __builtin_prefetch(&table.marks[table.index(key.hash)]);
}

void SampleTable::prefetch_sample(const Key& key) const {
    const int current = current_.load(std::memory_order_acquire);
    if (current < 0) return;
    const Table& table = *tables_[current];
    for (uint64_t i = 0; i < kProbes; ++i) {
        const uint64_t index = table.index(key.hash + i);
        const uint32_t mark = table.marks[index].load(std::memory_order_relaxed);
        if (mark == kEmpty) return;
        if (mark != mark_of(key.hash)) continue;
        const std::byte* slot = table.memory.get() + index * slot_bytes_;
        for (size_t line = 0; line < slot_bytes_; line += kCacheLine) __builtin_prefetch(slot + line);
        return;
    }
}

bool SampleTable::find(const Key& key, FastSample& sample) const {
    const int current = current_.load(std::memory_order_acquire);
    if (current < 0) return false;
    const Table& table = *tables_[current];
    const uint64_t hash = key.hash;
    for (uint64_t i = 0; i < kProbes; ++i) {
        const uint64_t index = table.index(hash + i);
        uint32_t mark = table.marks[index].load(std::memory_order_relaxed);
        if (mark == kEmpty) return false;
        if (mark != mark_of(hash)) continue;
        if (!table.marks[index].compare_exchange_strong(mark, kBusy, std::memory_order_acquire)) continue;
        const Slot& slot = *slot_at(table, index);
        const bool found = slot.point == key.point;
        if (found) read(slot, sample);
        table.marks[index].store(mark, std::memory_order_release);
        if (found) return true;
    }
    return false;
}

/// Whether the sample went into an empty slot.
bool SampleTable::put_in(Table& table, const Key& key, const FastSample& sample) {
    const uint64_t hash = key.hash;
    for (uint64_t i = 0; i <= kProbes; ++i) {
        const bool last = i == kProbes;  // all are taken: one of them, told by the hash, is forgotten
        const uint64_t index = table.index(last ? hash + (hash >> 32) % kProbes : hash + i);
        uint32_t mark = table.marks[index].load(std::memory_order_relaxed);
        if (mark == kBusy || (!last && mark != kEmpty)) continue;
        if (!table.marks[index].compare_exchange_strong(mark, kBusy, std::memory_order_acquire)) continue;
        Slot& slot = *slot_at(table, index);
        slot.point = key.point;
        write(slot, sample);
        table.marks[index].store(mark_of(hash), std::memory_order_release);
        return mark == kEmpty;
    }
    return false;
}

void SampleTable::put(const Key& key, const FastSample& sample) {
    int current = current_.load(std::memory_order_acquire);
    if (current < 0 || tables_[current]->filled.load(std::memory_order_relaxed) * kFullDenominator >
                           tables_[current]->slots * kFullNumerator) {
        grow();
        current = current_.load(std::memory_order_acquire);
        if (current < 0) return;
    }
    Table& table = *tables_[current];
    if (!put_in(table, key, sample)) return;
    table.filled.fetch_add(1, std::memory_order_relaxed);
    count_.fetch_add(1, std::memory_order_relaxed);
}

/// Returns how many there are.
uint64_t SampleTable::copy(const Table& from, Table& to) {
    uint64_t filled = 0;
    FastSample sample;
    for (uint64_t i = 0; i < from.slots; ++i) {
        uint32_t mark = from.marks[i].load(std::memory_order_relaxed);
        if (mark == kEmpty || mark == kBusy) continue;
        if (!from.marks[i].compare_exchange_strong(mark, kBusy, std::memory_order_acquire)) continue;
        const Slot& slot = *slot_at(from, i);
        read(slot, sample);
        filled += put_in(to, key_of(slot.point), sample) ? 1 : 0;
        from.marks[i].store(mark, std::memory_order_release);
    }
    return filled;
}

/// A larger table, with what the last one holds; unless another thread is at it, or memory is at its limit.
void SampleTable::grow() {
    if (growing_.exchange(true, std::memory_order_acquire)) return;
    const int current = current_.load(std::memory_order_relaxed);
    uint64_t slots = current < 0 ? kFirstSlots : kGrowth * tables_[current]->slots;
    const auto bytes_of = [&](uint64_t count) { return count * (slot_bytes_ + sizeof(uint32_t)); };
    if (current >= 0 && bytes() + bytes_of(slots) > most_bytes_) slots = 2 * tables_[current]->slots;
    const uint64_t more = bytes_of(slots);
    if (current + 1 < kMostTables && bytes() + more <= most_bytes_) {
        auto table = std::make_unique<Table>();
        table->slots = slots;
        table->marks.reset(new (std::nothrow) std::atomic<uint32_t>[slots]());
        // Small pages for what a small object needs.
        table->memory = large_memory(slots * slot_bytes_, slots * slot_bytes_ < kLargeTable ? kLargeTable : 0);
        if (table->marks && table->memory) {
            const uint64_t filled = current < 0 ? 0 : copy(*tables_[current], *table);
            table->filled.store(filled, std::memory_order_relaxed);
            count_.store(filled, std::memory_order_relaxed);
            bytes_.fetch_add(more, std::memory_order_relaxed);
            tables_[current + 1] = std::move(table);
            current_.store(current + 1, std::memory_order_release);
        }
    }
    growing_.store(false, std::memory_order_release);
}

}  // namespace rayleaf
