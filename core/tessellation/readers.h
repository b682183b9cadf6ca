// Who reads a cache right now, so that nothing is overwritten under a reader. No reader ever waits.
//
// Each thread announces the epoch in which its ray began. What a writer takes out of the cache gets the epoch's number
// and moves it on; its memory is used again once every announced epoch is later (Fraser, "Practical lock-freedom",
// 2004, section 5.2.3). A ray lasts microseconds, so memory is back soon.
//
// All of it pairs through one order of all (sequential consistency): a reader announces, then looks things up
// (tessellation/grid_index.h); a writer takes something out of the index, moves the epoch on, and later looks at what
// is announced. Who is not seen there looks things up after they were taken out.
#pragma once

#include "base/thread_states.h"

#include <atomic>
#include <cstdint>

namespace rayleaf {

class ReaderEpochs {
    static constexpr uint64_t kNobody = 0;

  public:
    /// One thread's.
    class Reader {
      public:
        bool is_inside() const { return epoch_.load(std::memory_order_relaxed) != kNobody; }

      private:
        friend class ReaderEpochs;
        /// Announces an epoch, to oldest(); kNobody: what was read has been read (release).
        std::atomic<uint64_t> epoch_{kNobody};
    };

    /// This thread's.
    Reader& reader() { return readers_.local(); }
    /// From now on this reader may look into the cache.
    void enter(Reader& reader) { reader.epoch_.store(current_.load()); }
    static void leave(Reader& reader) { reader.epoch_.store(kNobody, std::memory_order_release); }

    /// After something was taken out: the stamp with which it may be asked about.
    uint64_t advance() { return current_.fetch_add(1); }
    /// Everything stamped before this is seen by no one any more.
    uint64_t oldest() const {
        uint64_t oldest = current_.load();
        readers_.for_each([&](const Reader& each) {
            const uint64_t epoch = each.epoch_.load();
            if (epoch != kNobody && epoch < oldest) oldest = epoch;
        });
        return oldest;
    }
    /// What a thread takes.
    static constexpr size_t reader_bytes() { return ThreadStates<Reader>::state_bytes(); }

  private:
    std::atomic<uint64_t> current_{1};
    ThreadStates<Reader> readers_;
};

}  // namespace rayleaf
