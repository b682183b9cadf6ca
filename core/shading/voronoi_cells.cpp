#include "shading/voronoi_cells.h"

#include "base/simd.h"

#include <algorithm>
#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shading/voronoi_cells.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef RAYLEAF_VORONOI_STEPS
#define RAYLEAF_VORONOI_STEPS
namespace rayleaf {

/// Steps from the middle cell to those around it, by axis.
struct VoronoiSteps {
    size_t count = 1;
    alignas(64) std::array<std::array<float, VoronoiCells::kMost>, 4> step{};

    VoronoiSteps(int dimensions, int reach) {
        const auto side = static_cast<size_t>(2 * reach + 1);
        for (int axis = 0; axis < dimensions; ++axis) count *= side;
        for (size_t i = 0; i < VoronoiCells::kMost; ++i) {
            size_t rest = std::min(i, count - 1);
            for (auto& along : step) {
                along[i] = static_cast<float>(static_cast<int>(rest % side) - reach);
                rest /= side;
            }
        }
    }
};

/// `dimensions` 1..4, `reach` 1 or 2.
const VoronoiSteps& steps_of(int dimensions, int reach);

}  // namespace rayleaf
#endif

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "shading/hash_vectors.inl"

using Ints = hn::RebindToSigned<Floats>;
static_assert(VoronoiCells::kMost % kWidth == 0);

// Each function does for every lane what the one of its name in lattice_hash.h or voronoi.cpp does for one point.

/// Rounded once, as numbers without lanes are.
HWY_INLINE Float to_float(Word x) {
    const auto part = [](Word half) { return hn::ConvertTo(Floats(), hn::BitCast(Ints(), half)); };
    return hn::Add(hn::Mul(part(hn::ShiftRight<16>(x)), all(65536.0f)), part(hn::And(x, all_words(0xffffu))));
}

template <int N>
HWY_INLINE Float unit_hash(const Float* key) {
    Word words[N];
    for (int i = 0; i < N; ++i) words[i] = hn::BitCast(Words(), key[i]);
    return hn::Mul(to_float(jenkins_hash<N>(words)), all(1.0f / 4294967295.0f));
}

template <int N>
HWY_INLINE void chance(const Float* c, Float* result) {
    if constexpr (N == 1) {
        result[0] = unit_hash<1>(c);
    } else if constexpr (N == 4) {
        const Float turned[3][4] = {{c[3], c[0], c[1], c[2]}, {c[2], c[3], c[0], c[1]}, {c[1], c[2], c[3], c[0]}};
        result[0] = unit_hash<4>(c);
        for (int i = 0; i < 3; ++i) result[i + 1] = unit_hash<4>(turned[i]);
    } else {
        Float key[N + 1];
        for (int i = 0; i < N; ++i) key[i] = c[i];
        result[0] = unit_hash<N>(c);
        for (int i = 1; i < N; ++i) {
            key[N] = all(static_cast<float>(i));
            result[i] = unit_hash<N + 1>(key);
        }
    }
}

template <int N>
HWY_INLINE void pcg_mix(Word* v) {
    const auto add = [v](int to, Word a, Word b) { v[to] = hn::Add(v[to], hn::Mul(a, b)); };
    if constexpr (N == 2) {
        add(0, v[1], all_words(1664525u));
        add(1, v[0], all_words(1664525u));
    } else if constexpr (N == 3) {
        add(0, v[1], v[2]);
        add(1, v[2], v[0]);
        add(2, v[0], v[1]);
    } else {
        add(0, v[1], v[3]);
        add(1, v[2], v[0]);
        add(2, v[0], v[1]);
        add(3, v[1], v[2]);
    }
}

template <int N>
HWY_INLINE void pcg_hash(const Float* point, Float* result) {
    constexpr float kMost = 2147483520.0f, kPositive = 2147483647.0f;
    Word v[N];
    for (int i = 0; i < N; ++i) {
        const Float limited = hn::Min(hn::Max(point[i], all(-kMost)), all(kMost));
        const Word word = hn::BitCast(Words(), hn::ConvertTo(Ints(), limited));
        v[i] = hn::Add(hn::Mul(word, all_words(1664525u)), all_words(1013904223u));
    }
    pcg_mix<N>(v);
    for (Word& word : v) word = hn::Xor(word, hn::BitCast(Words(), hn::ShiftRight<16>(hn::BitCast(Ints(), word))));
    pcg_mix<N>(v);
    for (int i = 0; i < N; ++i) {
        const Word positive = hn::And(v[i], all_words(0x7fffffffu));
        result[i] = hn::Mul(hn::ConvertTo(Floats(), hn::BitCast(Ints(), positive)), all(1.0f / kPositive));
    }
}

template <int N>
HWY_INLINE Float distance(const Float* apart, CellDistance kind, VoronoiMetric metric) {
    Float sum = hn::Zero(Floats());
    if (kind == CellDistance::Metric && N == 1) return hn::Abs(apart[0]);
    if (kind == CellDistance::Squared || metric == VoronoiMetric::Euclidean) {
        for (int i = 0; i < N; ++i) sum = hn::Add(sum, hn::Mul(apart[i], apart[i]));
        return kind == CellDistance::Squared ? sum : hn::Sqrt(sum);
    }
    for (int i = 0; i < N; ++i)
        sum = metric == VoronoiMetric::Manhattan ? hn::Add(sum, hn::Abs(apart[i])) : hn::Max(sum, hn::Abs(apart[i]));
    return sum;
}

template <int N>
void find_cells(const VoronoiSteps& steps, VoronoiCells& cells) {
    const Floats tag;
    const Float randomness = all(cells.randomness);
    for (size_t first = 0; first < cells.count; first += kWidth) {
        Float place[N], by_chance[N], apart[N];
        for (int i = 0; i < N; ++i)
            place[i] = hn::Add(all(cells.cell[i]), hn::Add(all(cells.middle[i]), hn::Load(tag, &steps.step[i][first])));
        if constexpr (N > 1) {
            if (cells.hash == VoronoiHash::Pcg)
                pcg_hash<N>(place, by_chance);
            else
                chance<N>(place, by_chance);
        } else {
            chance<N>(place, by_chance);
        }
        for (int i = 0; i < N; ++i) {
            const Float offset = hn::Add(all(cells.middle[i]), hn::Load(tag, &steps.step[i][first]));
            const Float point = hn::Add(offset, hn::Mul(by_chance[i], randomness));
            hn::Store(point, tag, cells.point[i] + first);
            apart[i] = hn::Sub(point, all(cells.from[i]));
        }
        if constexpr (N == 3)
            for (int i = 0; i < N && cells.chances; ++i) hn::Store(by_chance[i], tag, cells.chance[i] + first);
        if (cells.distances != CellDistance::None)
            hn::Store(distance<N>(apart, cells.distances, cells.metric), tag, cells.distance + first);
    }
}

void find_all_cells(const VoronoiSteps& steps, VoronoiCells& cells) {
    switch (cells.dimensions) {
        case 1:
            return find_cells<1>(steps, cells);
        case 2:
            return find_cells<2>(steps, cells);
        case 3:
            return find_cells<3>(steps, cells);
        default:
            return find_cells<4>(steps, cells);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {

HWY_EXPORT(find_all_cells);

const VoronoiSteps& steps_of(int dimensions, int reach) {
    static const VoronoiSteps all[2][4] = {{{1, 1}, {2, 1}, {3, 1}, {4, 1}}, {{1, 2}, {2, 2}, {3, 2}, {4, 2}}};
    return all[reach - 1][dimensions - 1];
}

float VoronoiCells::offset(int axis, size_t i) const {
    return middle[axis] + steps_of(dimensions, reach).step[static_cast<size_t>(axis)][i];
}

void VoronoiCells::find() {
    const VoronoiSteps& steps = steps_of(dimensions, reach);
    count = steps.count;
    HWY_DYNAMIC_DISPATCH(find_all_cells)(steps, *this);
}

}  // namespace rayleaf
#endif
