// The hashes of lattice_hash.h over the lanes of vectors. Include it once in a kernel's file, inside namespace
// rayleaf::HWY_NAMESPACE, where `hn` is Highway's namespace: it is compiled for each instruction set, so it has no
// include guard.

using Floats = hn::CappedTag<float, 16>;
using Words = hn::RebindToUnsigned<Floats>;
using Float = hn::Vec<Floats>;
using Word = hn::Vec<Words>;
constexpr size_t kWidth = hn::MaxLanes(Floats());

HWY_INLINE Float all(float x) {
    return hn::Set(Floats(), x);
}
HWY_INLINE Word all_words(uint32_t x) {
    return hn::Set(Words(), x);
}
template <int kTurn>
HWY_INLINE Word rotated(Word x) {
    return hn::Or(hn::ShiftLeft<kTurn>(x), hn::ShiftRight<32 - kTurn>(x));
}

template <int kTurn>
HWY_INLINE void final_step(Word& x, Word y) {
    x = hn::Sub(hn::Xor(x, y), rotated<kTurn>(y));
}
HWY_INLINE Word final_mix(Word a, Word b, Word c) {
    final_step<14>(c, b);
    final_step<11>(a, c);
    final_step<25>(b, a);
    final_step<16>(c, b);
    final_step<4>(a, c);
    final_step<14>(b, a);
    final_step<24>(c, b);
    return c;
}

template <int kTurn>
HWY_INLINE void inner_step(Word& x, Word y, Word& z) {
    x = hn::Xor(hn::Sub(x, z), rotated<kTurn>(z));
    z = hn::Add(z, y);
}
HWY_INLINE void inner_mix(Word& a, Word& b, Word& c) {
    inner_step<4>(a, b, c);
    inner_step<6>(b, c, a);
    inner_step<8>(c, a, b);
    inner_step<16>(a, b, c);
    inner_step<19>(b, c, a);
    inner_step<4>(c, a, b);
}

template <int N>
HWY_INLINE Word jenkins_hash(const Word* key) {
    const Word start = all_words(0xdeadbeefu + (static_cast<uint32_t>(N) << 2) + 13u);
    Word words[3] = {start, start, start};
    for (int i = 0; i < std::min(N, 3); ++i) words[i] = hn::Add(words[i], key[i]);
    if constexpr (N > 3) {
        inner_mix(words[0], words[1], words[2]);
        words[0] = hn::Add(words[0], key[3]);
    }
    return final_mix(words[0], words[1], words[2]);
}
