#include "base/sample_pairs.h"

#include "base/simd.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/sample_pairs.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Words = hn::CappedTag<uint32_t, 16>;
using Word = hn::Vec<Words>;
constexpr size_t kWidth = hn::MaxLanes(Words());
static_assert(SamplePairs::kMost % kWidth == 0);

// Each function is the SIMD version of the one of the same name in random.h.

HWY_INLINE Word all(uint32_t x) {
    return hn::Set(Words(), x);
}
template <int kShift>
HWY_INLINE Word shifted_xor(Word x) {
    return hn::Xor(x, hn::ShiftRight<kShift>(x));
}

HWY_INLINE Word hash32(Word x) {
    x = hn::Mul(shifted_xor<16>(x), all(0x7feb352du));
    x = hn::Mul(shifted_xor<15>(x), all(0x846ca68bu));
    return shifted_xor<16>(x);
}
HWY_INLINE Word hash_combine(Word seed, Word value) {
    const Word sum =
        hn::Add(hn::Add(value, all(0x9e3779b9u)), hn::Add(hn::ShiftLeft<6>(seed), hn::ShiftRight<2>(seed)));
    return hash32(hn::Xor(seed, sum));
}

/// Exchanges neighbouring groups of `kBits` bits; `low` has the lower one of each two set.
template <int kBits>
HWY_INLINE Word exchanged(Word x, uint32_t low) {
    return hn::Or(hn::ShiftLeft<kBits>(hn::And(x, all(low))), hn::And(hn::ShiftRight<kBits>(x), all(low)));
}
HWY_INLINE Word reverse_bits(Word x) {
    x = hn::Or(hn::ShiftLeft<16>(x), hn::ShiftRight<16>(x));
    x = exchanged<8>(x, 0x00ff00ffu);
    x = exchanged<4>(x, 0x0f0f0f0fu);
    x = exchanged<2>(x, 0x33333333u);
    return exchanged<1>(x, 0x55555555u);
}

HWY_INLINE Word laine_karras(Word x, Word seed) {
    x = hn::Xor(x, hn::Mul(x, all(0x3d20adeau)));
    x = hn::Add(x, seed);
    x = hn::Mul(x, hn::Or(hn::ShiftRight<16>(seed), all(1u)));
    x = hn::Xor(x, hn::Mul(x, all(0x05526c56u)));
    return hn::Xor(x, hn::Mul(x, all(0x53a22864u)));
}

template <int kShift>
HWY_INLINE Word folded(Word x, uint32_t digits) {
    return hn::Xor(x, hn::ShiftRight<kShift>(hn::And(x, all(digits))));
}
HWY_INLINE Word sobol_second_reversed(Word index) {
    index = folded<1>(index, 0xaaaaaaaau);
    index = folded<2>(index, 0xccccccccu);
    index = folded<4>(index, 0xf0f0f0f0u);
    index = folded<8>(index, 0xff00ff00u);
    return folded<16>(index, 0xffff0000u);
}

HWY_INLINE Word times_matrix(Word index, Word matrix) {
    const hn::RebindToSigned<Words> places;
    const auto digits = [&](int step) HWY_ATTR {
        return hn::GatherIndex(Words(), kMatrixDigits[step], hn::BitCast(places, matrix));
    };
    index = hn::Xor(index, hn::ShiftRight<kMatrixShifts[0]>(hn::And(index, digits(0))));
    index = hn::Xor(index, hn::ShiftRight<kMatrixShifts[1]>(hn::And(index, digits(1))));
    index = hn::Xor(index, hn::ShiftRight<kMatrixShifts[2]>(hn::And(index, digits(2))));
    return hn::Xor(index, hn::ShiftRight<kMatrixShifts[3]>(hn::And(index, digits(3))));
}

HWY_INLINE hn::Vec<hn::RebindToFloat<Words>> unit_float(Word bits) {
    const hn::RebindToFloat<Words> floats;
    const hn::RebindToSigned<Words> ints;
    return hn::Mul(hn::ConvertTo(floats, hn::BitCast(ints, hn::ShiftRight<8>(bits))), hn::Set(floats, 0x1p-24f));
}

void compute_pairs(SamplePairs& pairs) {
    const Words words;
    const hn::RebindToFloat<Words> floats;
    for (size_t first = 0; first < pairs.count; first += kWidth) {
        const Word pixel_hash = hn::Load(words, pairs.pixel_hash + first);
        const Word dimension = hn::Load(words, pairs.dimension + first);
        const Word seed = hash_combine(pixel_hash, dimension);
        const Word shuffle = hn::IfThenElse(hn::Lt(dimension, all(kSharing)), hash_combine(pixel_hash, all(0u)), seed);
        const Word sample = hn::Load(words, pairs.sample + first);
        const Word shuffled = reverse_bits(laine_karras(reverse_bits(sample), shuffle));
        const Word index = times_matrix(shuffled, hn::Min(dimension, all(kSharing)));
        // Reversals that cancel are left out.
        const Word x = reverse_bits(laine_karras(index, hash_combine(seed, all(1u))));
        const Word y = reverse_bits(laine_karras(sobol_second_reversed(index), hash_combine(seed, all(2u))));
        hn::Store(unit_float(x), floats, pairs.x + first);
        hn::Store(unit_float(y), floats, pairs.y + first);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {

HWY_EXPORT(compute_pairs);

void SamplePairs::compute() {
    // Lanes beyond the last pair compute with arbitrary numbers.
    const size_t end = std::min(kMost, (count + 15) / 16 * 16);
    for (uint32_t* row : {pixel_hash, sample, dimension}) std::fill(row + count, row + end, 0u);
    HWY_DYNAMIC_DISPATCH(compute_pairs)(*this);
}

}  // namespace rayleaf
#endif
