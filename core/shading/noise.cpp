#include "shading/noise.h"

#include "base/float4.h"
#include "shading/lattice_hash.h"
#include "shading/noise_lanes.h"

#include <array>
#include <bit>
#include <cstdint>

namespace rayleaf {
namespace {

template <int N>
LatticePoint<N> plus(LatticePoint<N> a, const LatticePoint<N>& b) {
    for (int i = 0; i < N; ++i) a[i] += b[i];
    return a;
}
template <int N>
LatticePoint<N> times(LatticePoint<N> a, float factor) {
    for (float& x : a) x *= factor;
    return a;
}

/// The corners of a lattice cell, four at a time: what each computes is what it would alone.
using Words4 = uint32_t __attribute__((vector_size(16)));

/// jenkins_hash() of four keys of three words.
Words4 jenkins_hash4(Words4 a, Words4 b, Words4 c) {
    constexpr uint32_t kStart = 0xdeadbeefu + (3u << 2) + 13u;
    return final_mix<Words4>(a + kStart, b + kStart, c + kStart);
}

float negated_if(uint32_t condition, float x) {
    return condition ? -x : x;
}

// Scalar products of the offset from a lattice point with the gradient that the hash names.
float gradient(uint32_t hash, const LatticePoint<1>& p) {
    const float slope = 1.0f + static_cast<float>(hash & 7u);
    return negated_if(hash & 8u, slope) * p[0];
}
float gradient(uint32_t hash, const LatticePoint<2>& p) {
    const bool first = (hash & 7u) < 4u;
    const float u = first ? p[0] : p[1], v = 2.0f * (first ? p[1] : p[0]);
    return negated_if(hash & 1u, u) + negated_if(hash & 2u, v);
}
float gradient(uint32_t hash, const LatticePoint<4>& p) {
    const uint32_t h = hash & 31u;
    const float u = h < 24u ? p[0] : p[1], v = h < 16u ? p[1] : p[2], s = h < 8u ? p[2] : p[3];
    return negated_if(h & 1u, u) + negated_if(h & 2u, v) + negated_if(h & 4u, s);
}

Float4 with_sign_of(Words4 bits, int bit, Float4 x) {
    return std::bit_cast<Float4>(std::bit_cast<Words4>(x) ^ (bits >> bit & 1u) << 31);
}

/// gradient() in three dimensions at four corners.
Float4 gradient4(Words4 hash, Float4 x, Float4 y, Float4 z) {
    const Words4 h = hash & 15u;
    const Float4 u = h < 8u ? x : y;
    const Float4 v = h < 4u ? y : ((h == 12u) | (h == 14u) ? x : z);
    return with_sign_of(h, 0, u) + with_sign_of(h, 1, v);
}

/// The values at the eight corners of a cell in three dimensions: corner i lies at the bits of i, x lowest.
void corner_values(const std::array<uint32_t, 3>& cell, const LatticePoint<3>& fraction, float* values) {
    const uint32_t x0 = cell[0], x1 = cell[0] + 1u, y0 = cell[1], y1 = cell[1] + 1u;
    const Words4 x{x0, x1, x0, x1}, y{y0, y0, y1, y1};
    const Float4 from_x{fraction[0], fraction[0] - 1.0f, fraction[0], fraction[0] - 1.0f};
    const Float4 from_y{fraction[1], fraction[1], fraction[1] - 1.0f, fraction[1] - 1.0f};
    for (int k = 0; k < 2; ++k) {
        const uint32_t z = cell[2] + static_cast<uint32_t>(k);
        const Words4 hash = jenkins_hash4(x, y, Words4{z, z, z, z});
        const Float4 value = gradient4(hash, from_x, from_y, all4(k == 0 ? fraction[2] : fraction[2] - 1.0f));
        for (int i = 0; i < 4; ++i) values[4 * k + i] = value[i];
    }
}

template <int N>
void corner_values(const std::array<uint32_t, N>& cell, const LatticePoint<N>& fraction, float* values) {
    for (int corner = 0; corner < (1 << N); ++corner) {
        std::array<uint32_t, N> lattice = cell;
        LatticePoint<N> offset = fraction;
        for (int i = 0; i < N; ++i) {
            if (((corner >> i) & 1) == 0) continue;
            lattice[i] += 1u;
            offset[i] -= 1.0f;
        }
        values[corner] = gradient(jenkins_hash(lattice), offset);
    }
}

}  // namespace

template <int N>
float signed_noise(const LatticePoint<N>& p) {
    LatticePoint<N> fraction{}, blend{};
    std::array<uint32_t, N> cell{};
    for (int i = 0; i < N; ++i) {
        const float x = std::abs(p[i]) < kNoiseLatticeLimit ? p[i] : 0.0f;
        const float base = std::floor(x);
        const float f = x - base;
        cell[i] = static_cast<uint32_t>(static_cast<int32_t>(base));
        fraction[i] = f;
        blend[i] = f * f * f * (f * (f * 6.0f - 15.0f) + 10.0f);
    }
    float corners[1 << N];
    if constexpr (N == 3)
        corner_values(cell, fraction, corners);
    else
        corner_values<N>(cell, fraction, corners);
    for (int i = 0, count = 1 << N; i < N; ++i) {
        count /= 2;
        for (int j = 0; j < count; ++j) corners[j] = (1.0f - blend[i]) * corners[2 * j] + blend[i] * corners[2 * j + 1];
    }
    return corners[0] * kNoiseScale[N - 1];
}

template float signed_noise<1>(const LatticePoint<1>&);
template float signed_noise<2>(const LatticePoint<2>&);
template float signed_noise<3>(const LatticePoint<3>&);
template float signed_noise<4>(const LatticePoint<4>&);

namespace {

/// Of so many octaves at a point: one by one where they are few.
template <int N>
void noise_of_octaves(const LatticePoint<N>& p, float lacunarity, size_t count, NoisePoints& octaves) {
    float frequency = 1.0f;
    for (size_t i = 0; i < count; ++i, frequency *= lacunarity) {
        const LatticePoint<N> scaled = times<N>(p, frequency);
        if (count < NoisePoints::kLeast)
            octaves.noise[i] = signed_noise<N>(scaled);
        else
            octaves.add(scaled);
    }
    if (octaves.count > 0) octaves.compute(N);
}

/// Octaves of noise in [0, 1], weighted by powers of the roughness.
template <int N>
float fractal_noise(const LatticePoint<N>& p, const NoiseParameters& parameters) {
    const float detail = parameters.detail > 0.0f ? std::min(parameters.detail, kMostOctaves) : 0.0f;
    if (parameters.type != FractalType::FBM || !parameters.normalize)
        return fractal<N>(parameters.type, p,
                          {detail + 1.0f, std::max(parameters.roughness, 0.0f), parameters.lacunarity,
                           parameters.offset, parameters.gain});
    const float roughness = parameters.roughness > 0.0f ? std::min(parameters.roughness, 1.0f) : 0.0f;
    const float rest = detail - std::floor(detail);
    const size_t whole = static_cast<size_t>(detail) + 1, count = whole + (rest != 0.0f ? 1 : 0);
    NoisePoints octaves;
    noise_of_octaves<N>(p, parameters.lacunarity, count, octaves);
    const auto octave = [&octaves](size_t i) { return 0.5f * octaves.noise[i] + 0.5f; };
    float amplitude = 1.0f, sum = 0.0f, amplitudes = 0.0f;
    for (size_t i = 0; i < whole; ++i) {
        sum += octave(i) * amplitude;
        amplitudes += amplitude;
        amplitude *= roughness;
    }
    if (rest == 0.0f) return sum / amplitudes;
    const float finer = (sum + octave(whole) * amplitude) / (amplitudes + amplitude);
    return (1.0f - rest) * (sum / amplitudes) + rest * finer;
}

template <int N>
LatticePoint<N> seed_offset(int seed) {
    LatticePoint<N> offset{};
    for (int i = 0; i < N; ++i) offset[i] = noise_seed_offset(N, seed, i);
    return offset;
}

template <int N>
Vec3f texture(const LatticePoint<N>& point, const NoiseParameters& parameters, NoiseChannels channels) {
    LatticePoint<N> p = point;
    if (parameters.distortion != 0.0f)
        for (int i = 0; i < N; ++i) p[i] += signed_noise<N>(plus<N>(point, seed_offset<N>(i))) * parameters.distortion;
    const float factor = fractal_noise<N>(p, parameters);
    if (channels == NoiseChannels::Factor) return Vec3f(factor);
    return {factor, fractal_noise<N>(plus<N>(p, seed_offset<N>(N)), parameters),
            fractal_noise<N>(plus<N>(p, seed_offset<N>(N + 1)), parameters)};
}

}  // namespace

float noise_seed_offset(int dimensions, int seed, int axis) {
    const auto a = static_cast<float>(seed), b = static_cast<float>(axis);
    return 100.0f + 100.0f * (dimensions == 1 ? unit_hash(a) : unit_hash(a, b));
}

Vec3f noise_texture(int dimensions, const Vec4f& point, const NoiseParameters& parameters, NoiseChannels channels) {
    switch (dimensions) {
        case 1:
            return texture<1>({point.w}, parameters, channels);
        case 2:
            return texture<2>({point.x, point.y}, parameters, channels);
        case 3:
            return texture<3>({point.x, point.y, point.z}, parameters, channels);
        default:
            return texture<4>({point.x, point.y, point.z, point.w}, parameters, channels);
    }
}

}  // namespace rayleaf
