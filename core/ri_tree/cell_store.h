// The fast tree's cells in memory: read by any number of threads while others add to it, within a limit.
//
// Nodes and leaves are placed one after the other in one of two blocks, the current one. When that is full, the other
// becomes current, empty, and the full one is kept as the older: what is used again is copied over, not sampled anew.
// At the next change the older one is forgotten with all that nobody used. So what stays is what was used since the
// change before last; no time stamps are written when cells are read.
//
// A block is only emptied when no reader can have it: readers announce the epoch in which they began (epoch-based
// reclamation; Fraser, Practical Lock Freedom, 2004). No one waits: who finds no room, because the blocks cannot be
// exchanged yet or because there is none at all, works in memory of its own. Cells are pure functions of their keys, so
// it makes no difference to an answer.
#pragma once

#include "base/cache_line.h"
#include "base/large_memory.h"
#include "base/thread_states.h"
#include "ri_tree/cell_judge.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

namespace rayleaf {

/// What a cell is, and where: the verdict in the low bits, above them a place in the block, if it has one.
using CellRef = uint32_t;
inline constexpr int kVerdictBits = 3;
inline CellVerdict verdict_of(CellRef ref) {
    return static_cast<CellVerdict>(ref & ((1u << kVerdictBits) - 1));
}

/// Cells are tested at every fourth depth, so a node has sixteen children; one line of the processor's cache.
inline constexpr int kNodeChildren = 16;
struct alignas(kCacheLine) CellNode {
    /// Each publishes a node or leaf (release, when it is stored), to who goes down to it (acquire).
    std::array<std::atomic<CellRef>, kNodeChildren> children;
};

/// One of the two.
class CellBlock {
  public:
    /// Memory is taken from the system as it is used.
    explicit CellBlock(uint64_t bytes);

    std::atomic<CellRef>& root(uint8_t direction) { return roots_[direction]; }
    CellNode& node(CellRef ref) const {
        return *reinterpret_cast<CellNode*>(memory_.get() + (size_t{ref >> kVerdictBits}) * sizeof(CellNode));
    }
    const CellLeaf& leaf(CellRef ref) const {
        return *reinterpret_cast<const CellLeaf*>(memory_.get() + (size_t{ref >> kVerdictBits}) * sizeof(CellNode));
    }
    /// A node without children, or a copy of a leaf; empty if the block is full.
    std::optional<CellRef> add_node();
    std::optional<CellRef> add_leaf(const CellLeaf& leaf);
    void clear();

    uint64_t bytes() const { return used_.load(std::memory_order_relaxed) * sizeof(CellNode); }
    uint64_t nodes() const { return nodes_.load(std::memory_order_relaxed); }
    uint64_t leaves() const { return leaves_.load(std::memory_order_relaxed); }

  private:
    LargeMemory memory_;
    uint64_t capacity_ = 0;  ///< in units of a node, as all that follows
    /// As the children of a node.
    std::array<std::atomic<CellRef>, kLineDirections> roots_{};
    /// Written with every node and leaf, while others read the roots.
    alignas(kCacheLine) std::atomic<uint64_t> used_{0};
    std::atomic<uint64_t> nodes_{0}, leaves_{0};

    std::optional<uint64_t> take(uint64_t units);
};

struct CellCounts {
    std::array<std::atomic<uint64_t>, kAnswerKinds> answers{};
    std::atomic<uint64_t> samples_taken{0};
};

class CellStore {
    struct Thread;

  public:
    explicit CellStore(uint64_t bytes);

    /// A thread's leave to read and add, for a short time; one within another of the same thread knows what that knows.
    class Reader {
      public:
        explicit Reader(CellStore& store);
        ~Reader();
        Reader(const Reader&) = delete;
        Reader& operator=(const Reader&) = delete;

        CellBlock* current() const { return current_; }
        /// Null where there is none.
        CellBlock* older() const { return older_; }
        /// This reader's own.
        CellCounts& counts() const { return thread_.counts; }
        /// Told that there was no room.
        void found_no_room() { full_ = true; }

      private:
        CellStore& store_;
        Thread& thread_;
        CellBlock *current_ = nullptr, *older_ = nullptr;
        bool outermost_;
        bool full_ = false;
    };

    uint64_t bytes() const;
    uint64_t nodes() const { return blocks_[0].nodes() + blocks_[1].nodes(); }
    uint64_t leaves() const { return blocks_[0].leaves() + blocks_[1].leaves(); }
    uint64_t exchanges() const { return exchanges_.load(std::memory_order_relaxed); }
    uint64_t most_bytes() const { return most_bytes_.load(std::memory_order_relaxed); }
    uint64_t answers(size_t kind) const;
    uint64_t samples_taken() const;

  private:
    static constexpr uint64_t kNotReading = ~uint64_t{0};
    static constexpr uint32_t kCurrentBit = 1, kHasOlder = 2;

    struct Thread {
        /// Announces that blocks known in this epoch are read, before `state_` is; kNotReading: none are (release: what
        /// was read has been read). To exchange(), which empties no block that may be known. All of this pairs through
        /// one order of all: epoch, then state, here; state, then `epoch_`, then all threads' epochs there.
        std::atomic<uint64_t> epoch{kNotReading};
        CellCounts counts;
    };

    std::array<CellBlock, 2> blocks_;
    /// Which block is current, and whether the other is known; publishes that the current one has been emptied.
    std::atomic<uint32_t> state_{0};
    std::atomic<uint64_t> epoch_{0};
    ThreadStates<Thread> threads_;
    /// Taken by one thread at a time (acquire) that lets it go (release); holds `forgotten_since_` too.
    alignas(kCacheLine) std::atomic<bool> exchanging_{false};
    uint64_t forgotten_since_ = 0;  ///< readers of this epoch and later do not know the block that is not current
    std::atomic<uint64_t> exchanges_{0}, most_bytes_{0};

    void exchange();
};

}  // namespace rayleaf
