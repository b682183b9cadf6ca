// What one user at a time may change, kept from one user to the next.
#pragma once

#include <cstddef>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace rayleaf {

/// The values that were given back last. Thread-safe.
template <typename T>
class Spares {
  public:
    /// The value of which `likeness(value)` is highest, for good; empty if it is 0 for all.
    template <typename Likeness>
    std::optional<T> take(const Likeness& likeness) {
        const std::scoped_lock lock(mutex_);
        size_t best = values_.size(), most = 0;
        for (size_t i = 0; i < values_.size(); ++i) {
            const size_t alike = likeness(std::as_const(values_[i]));
            if (alike > most) most = alike, best = i;
        }
        if (most == 0) return std::nullopt;
        std::optional<T> taken(std::move(values_[best]));
        values_.erase(values_.begin() + static_cast<std::ptrdiff_t>(best));
        return taken;
    }
    void give_back(T value) {
        std::optional<T> dropped;  // freed without the lock
        const std::scoped_lock lock(mutex_);
        if (values_.size() == kMost) {
            dropped.emplace(std::move(values_.front()));
            values_.erase(values_.begin());
        }
        values_.push_back(std::move(value));
    }

  private:
    static constexpr size_t kMost = 2;
    std::mutex mutex_;
    std::vector<T> values_;
};

}  // namespace rayleaf
