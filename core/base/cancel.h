// A flag that one thread sets and many read: "stop as soon as you can".
#pragma once

#include <atomic>
#include <exception>

namespace rayleaf {

/// Thrown by cancelled work that cannot give a partial result.
class Cancelled : public std::exception {
  public:
    const char* what() const noexcept override { return "cancelled"; }
};

class CancelToken {
  public:
    void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
    bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

    void throw_if_cancelled() const {
        if (cancelled()) throw Cancelled();
    }

  private:
    std::atomic<bool> cancelled_{false};  ///< publishes nothing else
};

/// For work that is never cancelled.
inline const CancelToken kNeverCancelled;

}  // namespace rayleaf
