// A sequence of random numbers of unknown length: a pure function of what it is seeded with.
#pragma once

#include "base/random.h"

namespace rayleaf {

class RandomStream {
  public:
    RandomStream() = default;
    /// For one purpose of one sample, named by a dimension.
    RandomStream(const Sampler& sampler, uint32_t dimension)
        : key_(hash_combine(hash_combine(sampler.pixel_hash(), sampler.sample()), dimension)) {}

    /// In [0, 1).
    float next() { return unit_float(hash_combine(key_, count_++)); }

  private:
    uint32_t key_ = 0, count_ = 0;
};

}  // namespace rayleaf
