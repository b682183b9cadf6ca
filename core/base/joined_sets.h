// Disjoint sets of numbers (union-find with path halving, Tarjan and van Leeuwen 1984).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace rayleaf {

class JoinedSets {
  public:
    explicit JoinedSets(size_t count) : parents_(count) { std::iota(parents_.begin(), parents_.end(), 0u); }
    /// The lowest number of a set, which identifies it.
    uint32_t root(uint32_t i) {
        while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
        return i;
    }
    void join(uint32_t a, uint32_t b) {
        a = root(a);
        b = root(b);
        parents_[std::max(a, b)] = std::min(a, b);
    }

  private:
    std::vector<uint32_t> parents_;
};

}  // namespace rayleaf
