#include "ri_tree/sample_table.h"

#include "base/hash64.h"

#include <algorithm>
#include <cstring>
#include <new>

namespace rayleaf {
namespace {

constexpr uint64_t kFirstPlaces = 1024;
/// The entry of a sample is in one of this many neighbouring places.
constexpr uint64_t kProbes = 4;
/// The table grows when it is filled by more than 5/8, to four times its size.
constexpr uint64_t kGrowth = 4, kFullNumerator = 5, kFullDenominator = 8;
/// A chunk has at least so many samples.
constexpr uint64_t kLeastChunkSlots = 128;

uint64_t hash_of(const LatticePoint& point) {
    const uint64_t low = point.place[0] | uint64_t{point.place[1]} << 32;
    const uint64_t high = point.place[2] | uint64_t{point.place[3]} << 32;
    return hash64(hash64(low + point.direction) ^ high);
}

constexpr int kNumberBits = 32;

uint32_t mark_of(uint64_t entry) {
    return static_cast<uint32_t>(entry >> kNumberBits);
}

uint32_t number_of(uint64_t entry) {
    return static_cast<uint32_t>(entry);
}

/// RAII guard that tries to take a lock; false if another thread has it.
class TriedLock {
  public:
    explicit TriedLock(std::atomic<bool>& taken)
        : taken_(taken), is_held_(!taken.exchange(true, std::memory_order_acquire)) {}
    ~TriedLock() {
        if (is_held_) taken_.store(false, std::memory_order_release);
    }
    TriedLock(const TriedLock&) = delete;
    TriedLock& operator=(const TriedLock&) = delete;

    explicit operator bool() const { return is_held_; }

  private:
    std::atomic<bool>& taken_;
    bool is_held_;
};

}  // namespace

/// A slot, which its values follow, then their derivatives.
struct SampleTable::Slot {
    /// The slot's lock: set with acquire, reset with release. Only its holder reads and writes the slot.
    mutable std::atomic<bool> locked{false};
    SampleClass sample_class;
    LatticePoint point;

    float* numbers() { return reinterpret_cast<float*>(this + 1); }
    const float* numbers() const { return reinterpret_cast<const float*>(this + 1); }
    bool begin() const { return !locked.exchange(true, std::memory_order_acquire); }
    void end() const { locked.store(false, std::memory_order_release); }
};

struct SampleTable::Table {
    uint64_t size = 0;  ///< a power of two
    /// An entry publishes that the slot of its number exists, and `held_` (release; acquire in find and grow).
    std::unique_ptr<std::atomic<Entry>[]> places;
    alignas(kCacheLine) mutable std::atomic<uint64_t> filled{0};

    std::atomic<Entry>& place(uint64_t number) const { return places[number & (size - 1)]; }
    void enter(std::atomic<Entry>& place, Entry entry) const {
        Entry before = place.load(std::memory_order_relaxed);
        if (place.compare_exchange_strong(before, entry, std::memory_order_release) && before == 0)
            filled.fetch_add(1, std::memory_order_relaxed);
    }
    bool is_full() const { return filled.load(std::memory_order_relaxed) * kFullDenominator > size * kFullNumerator; }
};

SampleTable::SampleTable(OutputKind kind, SampleContents contents, uint64_t most_bytes)
    : values_(static_cast<size_t>(sample_value_count(kind))),
      changes_(contents == SampleContents::Values ? 0 : values_ * kLineAxes),
      slot_bytes_((sizeof(Slot) + (values_ + changes_) * sizeof(float) + alignof(Slot) - 1) / alignof(Slot) *
                  alignof(Slot)),
      most_bytes_(most_bytes),
      chunk_slots_(std::max(kLeastChunkSlots, most_bytes / kMostChunks / slot_bytes_ + 1)),
      chunks_(new std::atomic<std::byte*>[kMostChunks]()) {}

SampleTable::~SampleTable() {
    for (uint64_t i = 0; i < kMostChunks; ++i) delete[] chunks_[i].load(std::memory_order_relaxed);
}

const SampleTable::Table* SampleTable::current() const {
    const int current = current_.load(std::memory_order_acquire);
    return current < 0 ? nullptr : tables_[current].get();
}

SampleTable::Slot* SampleTable::slot_at(uint32_t number) const {
    const uint64_t held = held_.load(std::memory_order_relaxed), slot = number < held ? number : number % held;
    std::byte* chunk = chunks_[slot / chunk_slots_].load(std::memory_order_acquire);
    return std::launder(reinterpret_cast<Slot*>(chunk + slot % chunk_slots_ * slot_bytes_));
}

void SampleTable::read(const Slot& slot, FastSample& sample) const {
    sample.sample_class = slot.sample_class;
    if (slot.sample_class.is_miss()) return;
    std::memcpy(sample.values.data(), slot.numbers(), values_ * sizeof(float));
    std::memcpy(sample.changes.data(), slot.numbers() + values_, changes_ * sizeof(float));
}

void SampleTable::write(Slot& slot, const Key& key, const FastSample& sample) const {
    slot.point = key.point;
    slot.sample_class = sample.sample_class;
    if (sample.sample_class.is_miss()) return;
    std::memcpy(slot.numbers(), sample.values.data(), values_ * sizeof(float));
    std::memcpy(slot.numbers() + values_, sample.changes.data(), changes_ * sizeof(float));
}

SampleTable::Key SampleTable::key_of(const LatticePoint& point) {
    return {point, std::max(mark_of(hash_of(point)), 1u)};
}

void SampleTable::prefetch(const Key& key) const {
    if (const Table* table = current()) __builtin_prefetch(&table->place(key.mark));
}

void SampleTable::prefetch_sample(const Key& key) const {
    const Table* table = current();
    if (!table) return;
    for (uint64_t i = 0; i < kProbes; ++i) {
        const Entry entry = table->place(key.mark + i).load(std::memory_order_acquire);
        if (entry == 0) return;
        if (mark_of(entry) != key.mark) continue;
        const auto* slot = reinterpret_cast<const std::byte*>(slot_at(number_of(entry)));
        for (size_t line = 0; line < slot_bytes_; line += kCacheLine) __builtin_prefetch(slot + line);
        return;
    }
}

bool SampleTable::find(const Key& key, FastSample& sample) const {
    const Table* table = current();
    if (!table) return false;
    for (uint64_t i = 0; i < kProbes; ++i) {
        const Entry entry = table->place(key.mark + i).load(std::memory_order_acquire);
        if (entry == 0) return false;
        if (mark_of(entry) != key.mark) continue;
        const Slot& slot = *slot_at(number_of(entry));
        if (!slot.begin()) continue;
        const bool found = slot.point == key.point;
        if (found) read(slot, sample);
        slot.end();
        if (found) return true;
    }
    return false;
}

bool SampleTable::reserve(uint64_t bytes) {
    uint64_t before = bytes_.load(std::memory_order_relaxed);
    do {
        if (bytes > most_bytes_ || before > most_bytes_ - bytes) return false;
    } while (!bytes_.compare_exchange_weak(before, before + bytes, std::memory_order_relaxed));
    return true;
}

/// Makes the next chunk; only called by the holder of `making_chunk_`.
bool SampleTable::make_chunk(uint64_t chunk) {
    const uint64_t more = chunk_slots_ * slot_bytes_;
    if (chunk >= kMostChunks || !reserve(more)) return false;
    auto* made = new (std::nothrow) std::byte[more];
    if (!made) {
        bytes_.fetch_sub(more, std::memory_order_relaxed);
        return false;
    }
    for (uint64_t i = 0; i < chunk_slots_; ++i) new (static_cast<void*>(made + i * slot_bytes_)) Slot;
    chunks_[chunk].store(made, std::memory_order_release);
    return true;
}

/// Whether the next number has a slot, which is made if need be. If not, memory has room for none, or another thread is
/// making it.
bool SampleTable::has_slot(uint64_t number) {
    const uint64_t chunk = number / chunk_slots_;
    const auto is_made = [&] {
        return chunk < kMostChunks && chunks_[chunk].load(std::memory_order_acquire) != nullptr;
    };
    if (is_made()) return true;
    if (held_.load(std::memory_order_relaxed) == kNotFull) {
        const TriedLock maker(making_chunk_);
        if (!maker) return false;
        // Numbers are only taken where slots are, so all chunks before this one are there.
        const bool is_decided = is_made() || held_.load(std::memory_order_relaxed) != kNotFull;
        if (!is_decided && !make_chunk(chunk)) held_.store(chunk * chunk_slots_, std::memory_order_relaxed);
    }
    return held_.load(std::memory_order_relaxed) > 0;
}

/// Takes the next number. Once memory is full, numbers wrap around to the oldest slots. Empty if there is no slot.
std::optional<uint32_t> SampleTable::take_number() {
    uint64_t number = next_.load(std::memory_order_relaxed);
    do {
        if (!has_slot(number)) return std::nullopt;
    } while (!next_.compare_exchange_weak(number, number + 1, std::memory_order_relaxed));
    return static_cast<uint32_t>(number);
}

/// How many samples ago a number was taken.
uint32_t SampleTable::age_of(uint32_t number) const {
    return static_cast<uint32_t>(next_.load(std::memory_order_relaxed)) - number;
}

/// The place for a new sample among those of its mark: that of a forgotten sample, else a free one, else that of the
/// oldest sample.
std::atomic<SampleTable::Entry>& SampleTable::place_for(const Table& table, uint32_t mark) const {
    const uint64_t held = held_.load(std::memory_order_relaxed);
    std::atomic<Entry>* oldest = &table.place(mark);
    uint32_t most = 0;
    for (uint64_t i = 0; i < kProbes; ++i) {
        std::atomic<Entry>& place = table.place(mark + i);
        const Entry entry = place.load(std::memory_order_relaxed);
        if (entry == 0) return most > held ? *oldest : place;
        const uint32_t age = age_of(number_of(entry));
        if (age <= most) continue;
        most = age;
        oldest = &place;
    }
    return *oldest;
}

void SampleTable::put(const Key& key, const FastSample& sample) {
    const Table* table = current();
    if (!table || table->is_full()) {
        grow();
        table = current();
        if (!table) return;
    }
    const std::optional<uint32_t> number = take_number();
    if (!number) return;
    Slot& slot = *slot_at(*number);
    if (!slot.begin()) return;
    write(slot, key, sample);
    slot.end();
    // If another thread takes the place meanwhile, the sample is lost.
    table->enter(place_for(*table, key.mark), Entry{key.mark} << kNumberBits | *number);
}

/// Replaces the table by a larger one with the same entries, unless another thread does so, or memory is at its limit.
void SampleTable::grow() {
    const TriedLock grower(growing_);
    if (!grower) return;
    const int current = current_.load(std::memory_order_relaxed);
    const uint64_t size = current < 0 ? kFirstPlaces : kGrowth * tables_[current]->size;
    const uint64_t more = size * sizeof(Entry);
    if (current + 1 == kMostTables || !reserve(more)) return;
    std::unique_ptr<Table> table(new (std::nothrow) Table);
    if (table) table->places.reset(new (std::nothrow) std::atomic<Entry>[size]());
    if (!table || !table->places) {
        bytes_.fetch_sub(more, std::memory_order_relaxed);
        return;
    }
    table->size = size;
    for (uint64_t i = 0; current >= 0 && i < tables_[current]->size; ++i) {
        const Entry entry = tables_[current]->places[i].load(std::memory_order_acquire);
        const bool is_held = entry != 0 && age_of(number_of(entry)) <= held_.load(std::memory_order_relaxed);
        if (is_held) table->enter(place_for(*table, mark_of(entry)), entry);
    }
    tables_[current + 1] = std::move(table);
    current_.store(current + 1, std::memory_order_release);
}

}  // namespace rayleaf
