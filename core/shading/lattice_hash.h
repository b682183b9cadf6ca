// The hashes by which Blender's procedural textures choose what is at a lattice point: Bob Jenkins' lookup3 of a few
// words; and, for the cells of Voronoi since Blender 5.0, the PCG hashes of points of integers (Jarzynski, Olano: "Hash
// Functions for GPU Rendering", JCGT 9(3), 2020).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace rayleaf {

template <int N>
using LatticePoint = std::array<float, N>;

/// lookup3's final mixing of three words. `Word`: a number, or several in a vector of the compiler's.
template <typename Word>
Word final_mix(Word a, Word b, Word c) {
    const auto step = [](Word& x, Word y, int turn) {
        x ^= y;
        x -= y << turn | y >> (32 - turn);
    };
    step(c, b, 14);
    step(a, c, 11);
    step(b, a, 25);
    step(c, b, 16);
    step(a, c, 4);
    step(b, a, 14);
    step(c, b, 24);
    return c;
}

/// lookup3's inner mixing, needed where there are more than three words.
inline void inner_mix(uint32_t& a, uint32_t& b, uint32_t& c) {
    const auto step = [](uint32_t& x, uint32_t& y, uint32_t& z, int turn) {
        x -= z;
        x ^= std::rotl(z, turn);
        z += y;
    };
    step(a, b, c, 4);
    step(b, c, a, 6);
    step(c, a, b, 8);
    step(a, b, c, 16);
    step(b, c, a, 19);
    step(c, a, b, 4);
}

template <size_t N>
uint32_t jenkins_hash(const std::array<uint32_t, N>& key) {
    const uint32_t start = 0xdeadbeefu + (static_cast<uint32_t>(N) << 2) + 13u;
    uint32_t words[3] = {start, start, start};
    words[0] += key[0];
    if constexpr (N > 1) words[1] += key[1];
    if constexpr (N > 2) words[2] += key[2];
    if constexpr (N > 3) {
        inner_mix(words[0], words[1], words[2]);
        words[0] += key[3];
    }
    return final_mix(words[0], words[1], words[2]);
}

/// A number of 0..1 that the bits of some floats decide.
template <typename... Floats>
float unit_hash(Floats... key) {
    const std::array<uint32_t, sizeof...(key)> words{std::bit_cast<uint32_t>(static_cast<float>(key))...};
    return static_cast<float>(jenkins_hash(words)) * (1.0f / 4294967295.0f);
}

template <size_t N>
using LatticeWords = std::array<uint32_t, N>;

/// Each word is mixed with its neighbours. Blender's is that of signed words, so shifts repeat the sign.
template <size_t N>
void pcg_mix(LatticeWords<N>& v) {
    static_assert(N == 3 || N == 4);
    if constexpr (N == 3) {
        v[0] += v[1] * v[2];
        v[1] += v[2] * v[0];
        v[2] += v[0] * v[1];
    } else {
        v[0] += v[1] * v[3];
        v[1] += v[2] * v[0];
        v[2] += v[0] * v[1];
        v[3] += v[1] * v[2];
    }
}

/// A whole number as a word; what no word can hold becomes the nearest that one can.
inline uint32_t lattice_word(float x) {
    constexpr float kMost = 2147483520.0f;
    return static_cast<uint32_t>(static_cast<int32_t>(std::clamp(x, -kMost, kMost)));
}

/// Numbers of 0..1, as many as there are coordinates.
template <size_t N>
std::array<float, N> pcg_hash(const std::array<float, N>& point) {
    constexpr uint32_t kMultiplier = 1664525u, kIncrement = 1013904223u, kPositive = 0x7fffffffu;
    LatticeWords<N> v;
    for (size_t i = 0; i < N; ++i) v[i] = lattice_word(point[i]) * kMultiplier + kIncrement;
    pcg_mix<N>(v);
    for (uint32_t& word : v) word ^= static_cast<uint32_t>(static_cast<int32_t>(word) >> 16);
    pcg_mix<N>(v);
    std::array<float, N> result;
    for (size_t i = 0; i < N; ++i)
        result[i] = static_cast<float>(v[i] & kPositive) * (1.0f / static_cast<float>(kPositive));
    return result;
}

}  // namespace rayleaf
