// Bob Jenkins' lookup3 hash of a few words, by which Blender's procedural textures choose what is at a lattice point.
#pragma once

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

}  // namespace rayleaf
