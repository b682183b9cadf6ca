// Pairs of random numbers of many samplers at once, in the lanes of vectors: the same bits as Sampler::get2's.
#pragma once

#include "base/random.h"

#include <cstddef>
#include <cstdint>

namespace rayleaf {

/// What is asked for, and the answers. Rows are as long as the widest vectors need.
struct SamplePairs {
    static constexpr size_t kMost = 128;

    alignas(64) uint32_t pixel_hash[kMost], sample[kMost], dimension[kMost];
    alignas(64) float x[kMost], y[kMost];
    size_t count = 0;

    /// Asks for a pair; at most kMost of them.
    void add(const Sampler& sampler, uint32_t of_dimension) {
        pixel_hash[count] = sampler.pixel_hash();
        sample[count] = sampler.sample();
        dimension[count++] = of_dimension;
    }
    /// As Sampler::get3: the next two pairs.
    void add3(const Sampler& sampler, uint32_t of_dimension) {
        add(sampler, of_dimension);
        add(sampler, Sampler::joined(of_dimension));
    }
    /// Fills in the answers, in the order in which they were asked for.
    void compute();

    Vec2f pair(size_t i) const { return {x[i], y[i]}; }
    Vec3f triple(size_t first) const { return {x[first], y[first], x[first + 1]}; }
};

}  // namespace rayleaf
