// Who reads a cache right now, so that nothing is overwritten under a reader. No reader ever waits.
//
// Each thread announces the epoch in which its ray began. What a writer takes out of the cache gets the epoch's number
// and moves it on; its memory is used again once every announced epoch is later (Fraser, "Practical lock-freedom",
// 2004, section 5.2.3). A ray lasts microseconds, so memory is back soon.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace rayleaf {

/// Threads beyond so many at a time read without announcing, and so must not look into the cache.
inline constexpr int kMostReaders = 128;

/// A number below kMostReaders that no other living thread has, or -1.
int reader_number();

class ReaderEpochs {
  public:
    /// From now on this reader may look into the cache.
    void enter(int reader) {
        announced_[reader].epoch.store(current_.load(std::memory_order_acquire), std::memory_order_seq_cst);
    }
    void leave(int reader) { announced_[reader].epoch.store(kNobody, std::memory_order_release); }
    bool is_inside(int reader) const { return announced_[reader].epoch.load(std::memory_order_relaxed) != kNobody; }

    /// After something was taken out: the stamp with which it may be asked about.
    uint64_t advance() { return current_.fetch_add(1, std::memory_order_seq_cst); }
    /// Everything stamped before this is seen by no one any more.
    uint64_t oldest() const;

  private:
    static constexpr uint64_t kNobody = 0;
    struct alignas(64) Announced {
        std::atomic<uint64_t> epoch{kNobody};
    };
    std::atomic<uint64_t> current_{1};
    std::array<Announced, kMostReaders> announced_;
};

}  // namespace rayleaf
