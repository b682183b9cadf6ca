// The Bernstein basis at k/n, k = 0..n, n a power of two: what dicing at uniform parameters multiplies by.
//
// The table reads the same from both ends (value i at k equals value degree - i at n - k, bit by bit), so a border that
// two patches run through in opposite directions gets the same vertices from both.
#pragma once

#include <cstddef>
#include <vector>

namespace rayleaf {

class DyadicBasis {
  public:
    DyadicBasis(int degree, int intervals);
    int degree() const { return degree_; }
    int intervals() const { return intervals_; }
    /// B_i at k/n for k = first, first + 1, ...
    const float* values(int i, int first) const { return &values_[static_cast<size_t>(i) * (intervals_ + 1) + first]; }

  private:
    int degree_, intervals_;
    std::vector<float> values_;
};

}  // namespace rayleaf
