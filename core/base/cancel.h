// A flag that one thread sets and many read: "stop as soon as you can".
#pragma once

#include <atomic>

namespace rayleaf {

class CancelToken {
  public:
    void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
    bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

  private:
    std::atomic<bool> cancelled_{false};
};

}  // namespace rayleaf
