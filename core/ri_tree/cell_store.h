// The memory of the fast tree's cells, within a limit: any number of threads read it while others add to it.
//
// Nodes and leaves are appended to one of two blocks, the current one. When it is full, the other block is emptied and
// becomes current, and the full one is kept as the older block: cells that are used again are copied from it instead of
// sampled anew. At the next exchange the older block is forgotten. So cells used since the last exchange but one stay,
// and reading a cell writes no time stamp.
//
// A block is only emptied when no reader can have it (tessellation/readers.h). No thread waits: one that finds no room,
// because the blocks cannot be exchanged yet or because there is no memory at all, works in memory of its own. Cells
// are pure functions of their keys, so this does not change an answer.
#pragma once

#include "base/cache_line.h"
#include "base/large_memory.h"
#include "base/thread_states.h"
#include "ri_tree/cell_judge.h"
#include "tessellation/readers.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

namespace rayleaf {

/// A cell's verdict in the low bits, and above them its place in the block, if it has one.
using CellRef = uint32_t;
inline constexpr int kVerdictBits = 3;
inline CellVerdict verdict_of(CellRef ref) {
    return static_cast<CellVerdict>(ref & ((1u << kVerdictBits) - 1));
}

/// Cells are tested at every fourth depth, so a node has sixteen children: one cache line.
inline constexpr int kNodeChildren = 16;
struct alignas(kCacheLine) CellNode {
    /// Each publishes a node or leaf: stored with release, loaded with acquire by the thread that descends to it.
    std::array<std::atomic<CellRef>, kNodeChildren> children;
};

/// One of the two blocks.
class CellBlock {
  public:
    /// The system provides the memory page by page, as it is used.
    explicit CellBlock(uint64_t bytes);

    std::atomic<CellRef>& root(uint8_t direction) { return roots_[direction]; }
    CellNode& node(CellRef ref) const {
        return *reinterpret_cast<CellNode*>(memory_.get() + (size_t{ref >> kVerdictBits}) * sizeof(CellNode));
    }
    const CellLeaf& leaf(CellRef ref) const {
        return *reinterpret_cast<const CellLeaf*>(memory_.get() + (size_t{ref >> kVerdictBits}) * sizeof(CellNode));
    }
    /// Adds a node without children, or a copy of a leaf; empty if the block is full.
    std::optional<CellRef> add_node();
    std::optional<CellRef> add_leaf(const CellLeaf& leaf);
    void clear();

    uint64_t bytes() const { return used_.load(std::memory_order_relaxed) * sizeof(CellNode); }
    uint64_t nodes() const { return nodes_.load(std::memory_order_relaxed); }
    uint64_t leaves() const { return leaves_.load(std::memory_order_relaxed); }

  private:
    LargeMemory memory_;
    uint64_t capacity_ = 0;  ///< in units of a node, like all counts below
    /// By direction, like the children of a node.
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

    /// RAII guard that pins the blocks, so that a thread may read and add for a short time. One within another of the
    /// same thread knows what that one knows.
    class Reader {
      public:
        explicit Reader(CellStore& store);
        ~Reader();
        Reader(const Reader&) = delete;
        Reader& operator=(const Reader&) = delete;

        CellBlock* current() const { return current_; }
        /// Null if there is none.
        CellBlock* older() const { return older_; }
        /// The counters of this thread.
        CellCounts& counts() const { return thread_.counts; }
        /// Call it where a block had no room.
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
    static constexpr uint32_t kCurrentBit = 1, kHasOlder = 2;

    struct Thread {
        ReaderEpochs::Reader& reader;
        CellCounts counts;

        explicit Thread(ReaderEpochs& epochs) : reader(epochs.reader()) {}
    };

    std::array<CellBlock, 2> blocks_;
    /// Which block is current, and whether the other is known; publishes that the current one has been emptied. Readers
    /// announce themselves before they read it; exchange() empties no block that a reader announced before may know.
    std::atomic<uint32_t> state_{0};
    ReaderEpochs epochs_;
    ThreadStates<Thread> threads_;
    /// Taken by one thread at a time (acquire) that lets it go (release); protects `forgotten_` too.
    alignas(kCacheLine) std::atomic<bool> exchanging_{false};
    uint64_t forgotten_ = 0;  ///< stamp of when the block that is not current was forgotten; 0: it never was known
    std::atomic<uint64_t> exchanges_{0}, most_bytes_{0};

    void exchange();
};

}  // namespace rayleaf
