// Four floats in a SIMD register: plain IEEE operations on each, so results are the same as computed one by
// one.
#pragma once

#include <cmath>
#include <cstdint>

namespace rayleaf {

using Float4 = float __attribute__((vector_size(16)));

inline Float4 load4(const float* from) {
    return Float4{from[0], from[1], from[2], from[3]};
}
inline Float4 all4(float value) {
    return Float4{value, value, value, value};
}
/// Like std::min and std::max: the first if either is NaN.
inline Float4 min4(Float4 a, Float4 b) {
    return b < a ? b : a;
}
inline Float4 max4(Float4 a, Float4 b) {
    return a < b ? b : a;
}
inline Float4 sqrt4(Float4 a) {
    return Float4{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
}
/// The numbers reordered by the indices.
template <int i, int j, int k, int l>
Float4 shuffled(Float4 a) {
    return __builtin_shufflevector(a, a, i, j, k, l);
}
inline float sum_of(Float4 a) {
    return (a[0] + a[1]) + (a[2] + a[3]);
}
inline float least_of(Float4 a) {
    const Float4 pairs = min4(a, shuffled<2, 3, 0, 1>(a));
    return pairs[1] < pairs[0] ? pairs[1] : pairs[0];
}
inline float largest_of(Float4 a) {
    const Float4 pairs = max4(a, shuffled<2, 3, 0, 1>(a));
    return pairs[0] < pairs[1] ? pairs[1] : pairs[0];
}
/// A bit for each number that is at most `limit`.
inline uint32_t at_most(Float4 a, float limit) {
    const auto bit = [limit](float number, uint32_t value) { return number <= limit ? value : 0u; };
    return bit(a[0], 1u) | bit(a[1], 2u) | bit(a[2], 4u) | bit(a[3], 8u);
}

}  // namespace rayleaf
