#include "shading/noise_lanes.h"

#include "base/simd.h"
#include "shading/operations_pattern.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shading/noise_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "shading/hash_vectors.inl"

static_assert(NoiseLanes::kMost % kWidth == 0 && NoisePoints::kMost % kWidth == 0);

// Each function does for every lane what the one of its name in noise.cpp does for one point.

HWY_INLINE hn::Mask<Floats> below(Word h, uint32_t limit) {
    const hn::RebindToSigned<Floats> ints;
    return hn::RebindMask(Floats(), hn::Lt(hn::BitCast(ints, h), hn::Set(ints, static_cast<int32_t>(limit))));
}
HWY_INLINE hn::Mask<Floats> is(Word h, uint32_t value) {
    return hn::RebindMask(Floats(), hn::Eq(h, all_words(value)));
}
/// x, negated where the bit is set.
template <int kBit>
HWY_INLINE Float negated_if(Word bits, Float x) {
    const Word sign = hn::And(hn::ShiftLeft<31 - kBit>(bits), all_words(0x80000000u));
    return hn::BitCast(Floats(), hn::Xor(hn::BitCast(Words(), x), sign));
}

template <int N>
HWY_INLINE Float gradient(Word hash, const Float* p) {
    if constexpr (N == 1) {
        const hn::RebindToSigned<Floats> ints;
        const Word step = hn::And(hash, all_words(7));
        const Float slope = hn::Add(all(1.0f), hn::ConvertTo(Floats(), hn::BitCast(ints, step)));
        return hn::Mul(negated_if<3>(hash, slope), p[0]);
    } else if constexpr (N == 2) {
        const auto first = below(hn::And(hash, all_words(7)), 4);
        const Float u = hn::IfThenElse(first, p[0], p[1]);
        const Float v = hn::Mul(all(2.0f), hn::IfThenElse(first, p[1], p[0]));
        return hn::Add(negated_if<0>(hash, u), negated_if<1>(hash, v));
    } else if constexpr (N == 3) {
        const Word h = hn::And(hash, all_words(15));
        const Float u = hn::IfThenElse(below(h, 8), p[0], p[1]);
        const Float far = hn::IfThenElse(hn::Or(is(h, 12), is(h, 14)), p[0], p[2]);
        const Float v = hn::IfThenElse(below(h, 4), p[1], far);
        return hn::Add(negated_if<0>(h, u), negated_if<1>(h, v));
    } else {
        const Word h = hn::And(hash, all_words(31));
        const Float u = hn::IfThenElse(below(h, 24), p[0], p[1]);
        const Float v = hn::IfThenElse(below(h, 16), p[1], p[2]);
        const Float s = hn::IfThenElse(below(h, 8), p[2], p[3]);
        return hn::Add(hn::Add(negated_if<0>(h, u), negated_if<1>(h, v)), negated_if<2>(h, s));
    }
}

/// f³ (f (6 f - 15) + 10)
HWY_INLINE Float quintic(Float f) {
    const Float inner = hn::Add(hn::Mul(f, hn::Sub(hn::Mul(f, all(6.0f)), all(15.0f))), all(10.0f));
    return hn::Mul(hn::Mul(hn::Mul(f, f), f), inner);
}

template <int N>
HWY_INLINE Float signed_noise(const Float* p) {
    const hn::RebindToSigned<Floats> ints;
    Word cell[2][N];
    Float offset[2][N], blend[N];
    for (int i = 0; i < N; ++i) {
        const Float x = hn::IfThenElseZero(hn::Lt(hn::Abs(p[i]), all(kNoiseLatticeLimit)), p[i]);
        const Float base = hn::Floor(x);
        cell[0][i] = hn::BitCast(Words(), hn::ConvertTo(ints, base));
        cell[1][i] = hn::Add(cell[0][i], all_words(1));
        offset[0][i] = hn::Sub(x, base);
        offset[1][i] = hn::Sub(offset[0][i], all(1.0f));
        blend[i] = quintic(offset[0][i]);
    }
    Float corners[1 << N];
    for (int corner = 0; corner < (1 << N); ++corner) {
        Word lattice[N];
        Float from[N];
        for (int i = 0; i < N; ++i) {
            lattice[i] = cell[(corner >> i) & 1][i];
            from[i] = offset[(corner >> i) & 1][i];
        }
        corners[corner] = gradient<N>(jenkins_hash<N>(lattice), from);
    }
    for (int i = 0, count = 1 << N; i < N; ++i) {
        count /= 2;
        const Float rest = hn::Sub(all(1.0f), blend[i]);
        for (int j = 0; j < count; ++j)
            corners[j] = hn::Add(hn::Mul(rest, corners[2 * j]), hn::Mul(blend[i], corners[2 * j + 1]));
    }
    return hn::Mul(corners[0], all(kNoiseScale[N - 1]));
}

template <int N>
Float octave(const Float* p, Float frequency) {
    Float scaled[N];
    for (int i = 0; i < N; ++i) scaled[i] = hn::Mul(p[i], frequency);
    return hn::Add(hn::Mul(all(0.5f), signed_noise<N>(scaled)), all(0.5f));
}

/// A positive number, `most` at most; what is not positive becomes 0.
HWY_INLINE Float limited(Float x, float most) {
    return hn::IfThenElseZero(hn::Gt(x, hn::Zero(Floats())), hn::Min(x, all(most)));
}

struct Parameters {
    Float detail, roughness, lacunarity;
};

template <int N>
Float fractal_noise(const Float* p, const Parameters& parameters) {
    const Float detail = limited(parameters.detail, kMostOctaves), roughness = limited(parameters.roughness, 1.0f);
    const Float whole = hn::Floor(detail), rest = hn::Sub(detail, whole), one = all(1.0f);
    const int last = static_cast<int>(hn::GetLane(hn::MaxOfLanes(Floats(), whole)));
    Float frequency = one, amplitude = one, sum = all(0.0f), amplitudes = all(0.0f);
    for (int i = 0; i <= last; ++i) {
        const auto runs = hn::Le(all(static_cast<float>(i)), whole);
        sum = hn::IfThenElse(runs, hn::Add(sum, hn::Mul(octave<N>(p, frequency), amplitude)), sum);
        amplitudes = hn::IfThenElse(runs, hn::Add(amplitudes, amplitude), amplitudes);
        amplitude = hn::IfThenElse(runs, hn::Mul(amplitude, roughness), amplitude);
        frequency = hn::IfThenElse(runs, hn::Mul(frequency, parameters.lacunarity), frequency);
    }
    const Float coarse = hn::Div(sum, amplitudes);
    const auto is_whole = hn::Eq(rest, hn::Zero(Floats()));
    if (hn::AllTrue(Floats(), is_whole)) return coarse;
    const Float next = hn::Mul(octave<N>(p, frequency), amplitude);
    const Float finer = hn::Div(hn::Add(sum, next), hn::Add(amplitudes, amplitude));
    const Float blended = hn::Add(hn::Mul(hn::Sub(one, rest), coarse), hn::Mul(rest, finer));
    return hn::IfThenElse(is_whole, coarse, blended);
}

template <int N>
Float shifted_noise(const Float* p, int seed, const Parameters& parameters) {
    Float shifted[N];
    for (int i = 0; i < N; ++i) shifted[i] = hn::Add(p[i], all(noise_seed_offset(N, seed, i)));
    return fractal_noise<N>(shifted, parameters);
}

/// Moves the points by noise where they are distorted.
template <int N>
void distort(Float* p, Float distortion) {
    const auto moves = hn::Not(hn::Eq(distortion, hn::Zero(Floats())));
    if (hn::AllFalse(Floats(), moves)) return;
    Float moved[N];
    for (int i = 0; i < N; ++i) {
        Float place[N];
        for (int j = 0; j < N; ++j) place[j] = hn::Add(p[j], all(noise_seed_offset(N, i, j)));
        moved[i] = hn::IfThenElse(moves, hn::Add(p[i], hn::Mul(signed_noise<N>(place), distortion)), p[i]);
    }
    for (int i = 0; i < N; ++i) p[i] = moved[i];
}

/// The lanes from `first` on. One dimension is along w.
template <int N>
void texture(NoiseChannels channels, size_t first, NoiseLanes& lanes) {
    const Floats tag;
    Float p[N];
    for (int i = 0; i < N; ++i) p[i] = hn::Load(tag, lanes.point[N == 1 ? 3 : i] + first);
    distort<N>(p, hn::Load(tag, lanes.distortion + first));
    const Parameters parameters{hn::Load(tag, lanes.detail + first), hn::Load(tag, lanes.roughness + first),
                                hn::Load(tag, lanes.lacunarity + first)};
    hn::Store(fractal_noise<N>(p, parameters), tag, lanes.channels[0] + first);
    if (channels == NoiseChannels::Factor) return;
    hn::Store(shifted_noise<N>(p, N, parameters), tag, lanes.channels[1] + first);
    hn::Store(shifted_noise<N>(p, N + 1, parameters), tag, lanes.channels[2] + first);
}

template <int N>
void noise_of_points(NoisePoints& points) {
    const Floats tag;
    for (size_t first = 0; first < points.count; first += kWidth) {
        Float p[N];
        for (int i = 0; i < N; ++i) p[i] = hn::Load(tag, points.point[i] + first);
        hn::Store(signed_noise<N>(p), tag, points.noise + first);
    }
}

void noise_of_all_points(int dimensions, NoisePoints& points) {
    switch (dimensions) {
        case 1:
            return noise_of_points<1>(points);
        case 2:
            return noise_of_points<2>(points);
        case 3:
            return noise_of_points<3>(points);
        default:
            return noise_of_points<4>(points);
    }
}

void noise_of_lanes(int dimensions, NoiseChannels channels, NoiseLanes& lanes) {
    for (size_t first = 0; first < lanes.count; first += kWidth) {
        switch (dimensions) {
            case 1:
                texture<1>(channels, first, lanes);
                break;
            case 2:
                texture<2>(channels, first, lanes);
                break;
            case 3:
                texture<3>(channels, first, lanes);
                break;
            default:
                texture<4>(channels, first, lanes);
                break;
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {

HWY_EXPORT(noise_of_lanes);
HWY_EXPORT(noise_of_all_points);

namespace {

/// A row of numbers, zero beyond the last.
void fill(float* row, const NumberRow& numbers, size_t count) {
    for (size_t i = 0; i < count; ++i) row[i] = numbers[i];
    std::fill(row + count, row + NoiseLanes::kMost, 0.0f);
}

}  // namespace

void NoiseLanes::set_points(const std::array<NumberRow, 4>& coordinates, const NumberRow& scale) {
    for (size_t axis = 0; axis < 4; ++axis) {
        fill(point[axis], coordinates[axis], count);
        for (size_t i = 0; i < count; ++i) point[axis][i] = sound_coordinate(point[axis][i] * scale[i]);
    }
}

void NoiseLanes::set_parameters(const NumberRow& details, const NumberRow& roughnesses, const NumberRow& distortions,
                                const NumberRow& lacunarities) {
    fill(detail, details, count);
    fill(roughness, roughnesses, count);
    fill(distortion, distortions, count);
    fill(lacunarity, lacunarities, count);
}

void NoisePoints::compute(int dimensions) {
    for (int axis = 0; axis < dimensions; ++axis) std::fill(point[axis] + count, point[axis] + kMost, 0.0f);
    HWY_DYNAMIC_DISPATCH(noise_of_all_points)(dimensions, *this);
}

void noise_texture(int dimensions, NoiseChannels channels, NoiseLanes& lanes) {
    HWY_DYNAMIC_DISPATCH(noise_of_lanes)(dimensions, channels, lanes);
}

}  // namespace rayleaf
#endif
