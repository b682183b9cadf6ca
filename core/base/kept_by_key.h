// A cache of values that are costly to make, by a key of everything that they depend on.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <utility>

namespace rayleaf {

/// Thread-safe. Values that the last two users did not ask for are dropped, so an undo finds what the edit replaced.
template <typename Key, typename Value>
class KeptByKey {
  public:
    /// Call it for each user, before it asks.
    void next_user() {
        const std::scoped_lock lock(mutex_);
        std::erase_if(entries_, [&](const auto& entry) { return entry.second.asked + kUsersKept <= users_; });
        ++users_;
    }
    /// Value() if there is none.
    Value find(const Key& key) {
        const std::scoped_lock lock(mutex_);
        const auto found = entries_.find(key);
        if (found == entries_.end()) return {};
        found->second.asked = users_;
        return found->second.value;
    }
    void keep(const Key& key, Value value) {
        const std::scoped_lock lock(mutex_);
        entries_[key] = {std::move(value), users_};
    }

  private:
    static constexpr uint64_t kUsersKept = 2;
    struct Entry {
        Value value;
        uint64_t asked = 0;  ///< the user that asked last
    };
    std::mutex mutex_;
    std::map<Key, Entry> entries_;
    uint64_t users_ = 0;
};

}  // namespace rayleaf
