#include "ri_tree/cell_store.h"

#include <algorithm>
#include <cstring>

namespace rayleaf {
namespace {

/// As many units as the bits of a CellRef can address.
constexpr uint64_t kMostUnits = uint64_t{1} << (32 - kVerdictBits);

CellRef ref_of(CellVerdict verdict, uint64_t unit) {
    return static_cast<CellRef>(unit << kVerdictBits) | static_cast<CellRef>(verdict);
}

}  // namespace

CellBlock::CellBlock(uint64_t bytes) : capacity_(std::min(bytes / sizeof(CellNode), kMostUnits)) {
    if (capacity_ < 2) {
        capacity_ = 0;
        return;
    }
    memory_ = large_memory(capacity_ * sizeof(CellNode), kLargePage);
    if (!memory_) capacity_ = 0;
}

std::optional<uint64_t> CellBlock::take(uint64_t units) {
    uint64_t unit = used_.load(std::memory_order_relaxed);
    do {
        if (unit + units > capacity_) return std::nullopt;
    } while (!used_.compare_exchange_weak(unit, unit + units, std::memory_order_relaxed));
    return unit;
}

std::optional<CellRef> CellBlock::add_node() {
    const std::optional<uint64_t> unit = take(1);
    if (!unit) return std::nullopt;
    const CellRef ref = ref_of(CellVerdict::Halved, *unit);
    auto* node = new (memory_.get() + *unit * sizeof(CellNode)) CellNode;
    for (std::atomic<CellRef>& child : node->children) child.store(0, std::memory_order_relaxed);
    nodes_.fetch_add(1, std::memory_order_relaxed);
    return ref;
}

std::optional<CellRef> CellBlock::add_leaf(const CellLeaf& leaf) {
    const size_t bytes = leaf.stored_bytes();
    const std::optional<uint64_t> unit = take((bytes + sizeof(CellNode) - 1) / sizeof(CellNode));
    if (!unit) return std::nullopt;
    std::memcpy(memory_.get() + *unit * sizeof(CellNode), &leaf, bytes);
    leaves_.fetch_add(1, std::memory_order_relaxed);
    return ref_of(CellVerdict::Interpolated, *unit);
}

void CellBlock::clear() {
    for (std::atomic<CellRef>& root : roots_) root.store(0, std::memory_order_relaxed);
    used_.store(0, std::memory_order_relaxed);
    nodes_.store(0, std::memory_order_relaxed);
    leaves_.store(0, std::memory_order_relaxed);
}

CellStore::CellStore(uint64_t bytes) : blocks_{CellBlock(bytes / 2), CellBlock(bytes / 2)} {}

CellStore::Reader::Reader(CellStore& store)
    : store_(store), thread_(store.threads_.local(store.epochs_)), outermost_(!thread_.reader.is_inside()) {
    // The announced epoch may be older than the state read below: then blocks are only kept longer.
    if (outermost_) store.epochs_.enter(thread_.reader);
    const uint32_t state = store.state_.load();
    current_ = &store.blocks_[state & kCurrentBit];
    if ((state & kHasOlder) != 0) older_ = &store.blocks_[1 - (state & kCurrentBit)];
}

CellStore::Reader::~Reader() {
    if (outermost_) ReaderEpochs::leave(thread_.reader);
    if (full_) store_.exchange();
}

/// Forgets the older block. Once no reader can have it, empties it and makes it the current one.
void CellStore::exchange() {
    if (exchanging_.exchange(true, std::memory_order_acquire)) return;
    uint32_t state = state_.load();
    if ((state & kHasOlder) != 0) {
        state &= ~kHasOlder;
        state_.store(state);
        forgotten_ = epochs_.advance();
    }
    if (forgotten_ < epochs_.oldest()) {
        const uint32_t other = 1 - (state & kCurrentBit);
        uint64_t most = most_bytes_.load(std::memory_order_relaxed);
        most = std::max(most, bytes());
        most_bytes_.store(most, std::memory_order_relaxed);
        blocks_[other].clear();
        state_.store(other | kHasOlder);
        exchanges_.fetch_add(1, std::memory_order_relaxed);
    }
    exchanging_.store(false, std::memory_order_release);
}

uint64_t CellStore::bytes() const {
    return blocks_[0].bytes() + blocks_[1].bytes();
}

uint64_t CellStore::answers(size_t kind) const {
    uint64_t sum = 0;
    threads_.for_each(
        [&](const Thread& thread) { sum += thread.counts.answers[kind].load(std::memory_order_relaxed); });
    return sum;
}

uint64_t CellStore::samples_taken() const {
    uint64_t sum = 0;
    threads_.for_each(
        [&](const Thread& thread) { sum += thread.counts.samples_taken.load(std::memory_order_relaxed); });
    return sum;
}

}  // namespace rayleaf
