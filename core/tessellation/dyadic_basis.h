// The Bernstein basis at k/n, k = 0..n, n a power of two: the factors of dicing at uniform parameters.
//
// The table is symmetric (value i at k equals value degree - i at n - k, bit by bit), so a border gets the same
// vertices from two patches that run along it in opposite directions.
#pragma once

#include <cstddef>
#include <vector>

namespace rayleaf {

class DyadicBasis {
  public:
    DyadicBasis(int degree, int intervals) : DyadicBasis(degree, intervals, 0, intervals) {}
    /// Only k = first..first + steps.
    DyadicBasis(int degree, int intervals, int first, int steps);
    /// B_i at (first + k)/n for k = from, from + 1, ...
    const float* values(int i, int from) const {
        return &values_[static_cast<size_t>(i) * (steps_ + size_t{1}) + from];
    }
    size_t bytes() const { return sizeof(*this) + values_.capacity() * sizeof(float); }

  private:
    int steps_;
    std::vector<float> values_;
};

}  // namespace rayleaf
