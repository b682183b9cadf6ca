// Epoch-based reclamation: who reads a cache right now, so that nothing is overwritten under a reader. No one waits.
//
// Each thread announces the epoch in which it begins to read. A writer that takes something out of the cache stamps it
// with the current epoch and begins the next; the memory is used again once every announced epoch is later (Fraser,
// "Practical lock-freedom", 2004, section 5.2.3). Readers stay for microseconds, so memory is back soon.
//
// All operations are sequentially consistent: a reader announces itself, then looks things up; a writer takes something
// out of the index, begins the next epoch, and later looks at the announced ones. A reader that is not seen there looks
// things up after they were taken out.
#pragma once

#include "base/thread_states.h"

#include <atomic>
#include <cstdint>

namespace rayleaf {

class ReaderEpochs {
    static constexpr uint64_t kNobody = 0;

  public:
    /// The state of one thread.
    class Reader {
      public:
        bool is_inside() const { return epoch_.load(std::memory_order_relaxed) != kNobody; }

      private:
        friend class ReaderEpochs;
        /// The announced epoch, read by oldest(); kNobody: the thread has finished reading (release).
        std::atomic<uint64_t> epoch_{kNobody};
    };

    /// The calling thread's.
    Reader& reader() { return readers_.local(); }
    /// From now on this reader may look into the cache.
    void enter(Reader& reader) { reader.epoch_.store(current_.load()); }
    static void leave(Reader& reader) { reader.epoch_.store(kNobody, std::memory_order_release); }

    /// Begins the next epoch, after something was taken out; returns the stamp of what was.
    uint64_t advance() { return current_.fetch_add(1); }
    /// No reader sees what has an earlier stamp than this.
    uint64_t oldest() const {
        uint64_t oldest = current_.load();
        readers_.for_each([&](const Reader& each) {
            const uint64_t epoch = each.epoch_.load();
            if (epoch != kNobody && epoch < oldest) oldest = epoch;
        });
        return oldest;
    }
    /// Memory for one thread.
    static constexpr size_t reader_bytes() { return ThreadStates<Reader>::state_bytes(); }

  private:
    std::atomic<uint64_t> current_{1};
    ThreadStates<Reader> readers_;
};

}  // namespace rayleaf
