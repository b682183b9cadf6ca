#include "base/random.h"

namespace rayleaf {
namespace {

uint32_t reverse_bits(uint32_t x) {
    x = __builtin_bswap32(x);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
    x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
    return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
}

/// Laine-Karras style permutation: each bit depends on lower bits only, so on reversed bits it is an Owen scramble.
/// Constants of N. Vegdahl's improved version.
uint32_t laine_karras(uint32_t x, uint32_t seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

uint32_t owen_scramble(uint32_t x, uint32_t seed) {
    return reverse_bits(laine_karras(reverse_bits(x), seed));
}

/// Second Sobol dimension of a 32-bit index. Its generator matrix is Pascal's triangle mod 2, a tensor power of
/// ((1, 1), (0, 1)): five steps, each adding every digit with a bit of its place set to the digit without it.
uint32_t sobol_second(uint32_t index) {
    index ^= (index & 0xaaaaaaaau) >> 1;
    index ^= (index & 0xccccccccu) >> 2;
    index ^= (index & 0xf0f0f0f0u) >> 4;
    index ^= (index & 0xff00ff00u) >> 8;
    index ^= (index & 0xffff0000u) >> 16;
    return reverse_bits(index);
}

}  // namespace

Vec2f Sampler::get2(uint32_t dimension) const {
    const uint32_t seed = hash_combine(pixel_hash_, dimension);
    const uint32_t index = owen_scramble(sample_, seed);
    const uint32_t x = owen_scramble(reverse_bits(index), hash_combine(seed, 1));
    const uint32_t y = owen_scramble(sobol_second(index), hash_combine(seed, 2));
    return {unit_float(x), unit_float(y)};
}

}  // namespace rayleaf
