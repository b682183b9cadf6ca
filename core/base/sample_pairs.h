// Pairs of random numbers for many samplers at once, in SIMD lanes: the same bits as Sampler::get2.
#pragma once

#include "base/random.h"

#include <cstddef>
#include <cstdint>

namespace rayleaf {

/// Requests and answers. Rows are padded for the widest vectors.
struct SamplePairs {
    static constexpr size_t kMost = 128;

    alignas(64) uint32_t pixel_hash[kMost], sample[kMost], dimension[kMost];
    alignas(64) float x[kMost], y[kMost];
    size_t count = 0;

    /// Requests a pair; at most kMost of them.
    void add(const Sampler& sampler, uint32_t of_dimension) {
        pixel_hash[count] = sampler.pixel_hash();
        sample[count] = sampler.sample();
        dimension[count++] = of_dimension;
    }
    /// Requests the two pairs of Sampler::get3.
    void add3(const Sampler& sampler, uint32_t of_dimension) {
        add(sampler, of_dimension);
        add(sampler, Sampler::joined(of_dimension));
    }
    /// Computes the answers, in the order of the requests.
    void compute();

    Vec2f pair(size_t i) const { return {x[i], y[i]}; }
    Vec3f triple(size_t first) const { return {x[first], y[first], x[first + 1]}; }
};

}  // namespace rayleaf
