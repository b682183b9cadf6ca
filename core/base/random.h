// Random numbers as a pure function of (pixel, sample, dimension): no state, no order, the same on any thread.
//
// Each pair of dimensions is an Owen-scrambled Sobol (0,2)-sequence whose sample index is shuffled and whose digits are
// scrambled by hashes (Burley, "Practical Hash-based Owen Scrambling", JCGT 2020, sections 3-4). Pairs are padded: pair
// k uses its own shuffle, so any number of dimensions may be asked for.
//
// Padded pairs meet at random: where an edge crosses a pixel in the shadow of a lamp, 64 samples are spread evenly over
// the pixel and over the lamp, but not over both. So the first few pairs (`kSharing`), for what makes most noise, share
// one shuffle, and each has a matrix of its own that the index's digits are multiplied by: over GF(2), upper
// triangular, ones on the diagonal, which leaves it a (0,2)-sequence. The matrices are the best of a search for those
// by which four numbers of two pairs fill as many elementary intervals as can be (tests/core/pair_matrices.py).
#pragma once

#include "base/vector.h"

#include <algorithm>
#include <cstdint>

namespace rayleaf {

/// A 32-bit hash with full avalanche ("lowbias32", C. Wellons).
constexpr uint32_t hash32(uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return x;
}

constexpr uint32_t hash_combine(uint32_t seed, uint32_t value) {
    return hash32(seed ^ (value + 0x9e3779b9u + (seed << 6) + (seed >> 2)));
}

/// The top 24 bits of `bits` as a float in [0, 1).
constexpr float unit_float(uint32_t bits) {
    return static_cast<float>(bits >> 8) * 0x1p-24f;
}

inline uint32_t reverse_bits(uint32_t x) {
    x = __builtin_bswap32(x);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
    x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
    return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
}

/// Laine-Karras style permutation: each bit depends on lower bits only, so on reversed bits it is an Owen scramble.
/// Constants of N. Vegdahl's improved version.
inline uint32_t laine_karras(uint32_t x, uint32_t seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

inline uint32_t owen_scramble(uint32_t x, uint32_t seed) {
    return reverse_bits(laine_karras(reverse_bits(x), seed));
}

/// Second Sobol dimension of a 32-bit index, its digits in reverse order. Its generator matrix is Pascal's triangle mod
/// 2, a tensor power of
/// ((1, 1), (0, 1)): five steps, each adding every digit with a bit of its place set to the digit without it.
inline uint32_t sobol_second_reversed(uint32_t index) {
    index ^= (index & 0xaaaaaaaau) >> 1;
    index ^= (index & 0xccccccccu) >> 2;
    index ^= (index & 0xf0f0f0f0u) >> 4;
    index ^= (index & 0xff00ff00u) >> 8;
    index ^= (index & 0xffff0000u) >> 16;
    return index;
}

/// Dimensions below this one share a shuffle.
inline constexpr uint32_t kSharing = 7;
/// Their matrices as steps: each adds the digits of a mask to those that lie so many places before them. The last mask
/// of a step is that of all other dimensions, and adds none.
inline constexpr int kMatrixSteps = 4;
inline constexpr int kMatrixShifts[kMatrixSteps] = {1, 2, 3, 5};
alignas(32) inline constexpr uint32_t kMatrixDigits[kMatrixSteps][kSharing + 1] = {
    {0, 0xbec1f6c2, 0x13076ca6, 0x7863fe00, 0x8a309dc8, 0x763abce0, 0xadead50a, 0},
    {0, 0xcc4338b8, 0x2a8381d0, 0x861918cc, 0x8d72db14, 0x565405c0, 0x7f04241c, 0},
    {0, 0x040578d8, 0x336d9df0, 0xa392eb88, 0x0ffc95b8, 0x644455e8, 0x025d6270, 0},
    {0, 0x6b5499e0, 0xff3cc4e0, 0x4744ede0, 0xee133a60, 0x96157060, 0xc4bac520, 0},
};

inline uint32_t times_matrix(uint32_t index, uint32_t matrix) {
    for (int step = 0; step < kMatrixSteps; ++step)
        index ^= (index & kMatrixDigits[step][matrix]) >> kMatrixShifts[step];
    return index;
}

/// The random numbers of one (pixel, sample). Dimensions are named by the caller; equal arguments give equal numbers.
class Sampler {
  public:
    /// `pixel` is any integer unique to the pixel; `seed` is the scene's.
    Sampler(uint32_t pixel, uint32_t sample, uint32_t seed)
        : pixel_hash_(hash_combine(hash32(seed), pixel)), sample_(sample) {}

    float get1(uint32_t dimension) const { return get2(dimension).x; }
    /// Two numbers in [0,1)², stratified over the samples of the pixel.
    Vec2f get2(uint32_t dimension) const;
    /// Three numbers: a stratified pair and the first of the next sequence.
    Vec3f get3(uint32_t dimension) const {
        const Vec2f a = get2(dimension);
        return {a.x, a.y, get2(joined(dimension)).x};
    }
    /// The dimension whose first number is the third of get3.
    static constexpr uint32_t joined(uint32_t dimension) { return dimension ^ 0x40000000u; }

    /// The numbers of another sample of the pixel.
    Sampler of_sample(uint32_t sample) const {
        Sampler other = *this;
        other.sample_ = sample;
        return other;
    }

    uint32_t pixel_hash() const { return pixel_hash_; }
    uint32_t sample() const { return sample_; }

    /// The numbers of sub-ray `index` of `count` that this sample sends for the purpose `tag`: stratified over the
    /// sub-rays of all samples of the pixel, and best so where `count` is a power of two.
    Sampler branch(uint32_t index, uint32_t count, uint32_t tag) const {
        Sampler branch = *this;
        branch.pixel_hash_ = hash_combine(pixel_hash_, hash32(tag));
        branch.sample_ = sample_ * count + index;
        return branch;
    }

  private:
    uint32_t pixel_hash_;
    uint32_t sample_;
};

inline Vec2f Sampler::get2(uint32_t dimension) const {
    const uint32_t seed = hash_combine(pixel_hash_, dimension);
    const uint32_t shuffle = dimension < kSharing ? hash_combine(pixel_hash_, 0) : seed;
    const uint32_t index = times_matrix(owen_scramble(sample_, shuffle), std::min(dimension, kSharing));
    // owen_scramble() of both dimensions, without the reversals that cancel.
    const uint32_t x = reverse_bits(laine_karras(index, hash_combine(seed, 1)));
    const uint32_t y = reverse_bits(laine_karras(sobol_second_reversed(index), hash_combine(seed, 2)));
    return {unit_float(x), unit_float(y)};
}

}  // namespace rayleaf
