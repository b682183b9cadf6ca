// A 64-bit hash with full avalanche: the finalizer of SplitMix64 (Steele, Lea, Flood 2014; D. Stafford's variant 13).
#pragma once

#include <cstdint>

namespace rayleaf {

/// 2^64 over the golden ratio: SplitMix64's step. Added to what is hashed, it keeps zeros from staying zero.
inline constexpr uint64_t kHashStep = 0x9e3779b97f4a7c15;

constexpr uint64_t hash64(uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
    x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
    return x ^ (x >> 31);
}

}  // namespace rayleaf
