#include "tessellation/grid_measure.h"

#include "base/simd.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tessellation/grid_measure.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// 16 cells of a row in vectors.
using Lanes = hn::CappedTag<float, kGridCells>;
using Vector = hn::Vec<Lanes>;
constexpr int kWidth = static_cast<int>(hn::MaxLanes(Lanes()));

HWY_INLINE float largest_lane(Vector v) {
    return hn::GetLane(hn::MaxOfLanes(Lanes(), v));
}

HWY_INLINE void measure_box(const GridRows& rows, GridMeasure& out) {
    const Lanes lanes;
    for (int axis = 0; axis < 3; ++axis) {
        const float* vertices = rows.vertices[axis];
        auto low = hn::LoadU(lanes, vertices + kGridSize - kWidth), high = low;
        for (int k = 0; k + kWidth <= kGridSize; k += kWidth) {
            const auto here = hn::LoadU(lanes, vertices + k);
            low = hn::Min(low, here);
            high = hn::Max(high, here);
        }
        out.low[axis] = -largest_lane(hn::Neg(low));
        out.high[axis] = largest_lane(high);
    }
}

/// The larger of two, or the first if the second is NaN.
HWY_INLINE Vector larger(Vector a, Vector b) {
    return hn::IfThenElse(hn::Gt(b, a), b, a);
}

HWY_INLINE Vector plus_square(Vector sum, Vector v) {
    return hn::Add(sum, hn::Mul(v, v));
}

/// Differences within the columns from `start` on, except those along the grid's borders.
struct Differences {
    Vector uu, uv, vv;

    HWY_INLINE void add_columns(const GridRows& rows, int start) {
        const Lanes lanes;
        // Differences across the last vertex of a row do not count.
        HWY_ALIGN float inside[kWidth];
        for (int i = 0; i < kWidth; ++i) inside[i] = start + i + 2 < kGridVertices ? 1.0f : 0.0f;
        const auto mask = hn::Load(lanes, inside);
        Vector below[3] = {hn::Zero(lanes), hn::Zero(lanes), hn::Zero(lanes)}, here[3], next[3];
        for (int axis = 0; axis < 3; ++axis) {
            here[axis] = hn::LoadU(lanes, rows.vertices[axis] + start);
            next[axis] = hn::LoadU(lanes, rows.vertices[axis] + start + 1);
        }
        for (int j = 0; j < kGridCells; ++j) {
            auto along = hn::Zero(lanes), across = along, twist = along;
            for (int axis = 0; axis < 3; ++axis) {
                const float* p = rows.vertices[axis] + j * kGridVertices + start;
                const auto above = hn::LoadU(lanes, p + kGridVertices);
                const auto above_next = hn::LoadU(lanes, p + kGridVertices + 1), second = hn::LoadU(lanes, p + 2);
                along = plus_square(along, hn::Sub(hn::Add(here[axis], second), hn::Add(next[axis], next[axis])));
                across = plus_square(across, hn::Sub(hn::Add(below[axis], above), hn::Add(here[axis], here[axis])));
                twist = plus_square(twist, hn::Sub(hn::Add(here[axis], above_next), hn::Add(next[axis], above)));
                below[axis] = here[axis];
                here[axis] = above;
                next[axis] = above_next;
            }
            uu = larger(uu, hn::Mul(along, mask));
            uv = larger(uv, twist);
            if (j > 0) vv = larger(vv, across);
        }
    }
};

/// Measures the four borders side by side: vertex k of border b is at 4 k + b.
HWY_INLINE void measure_borders(const GridRows& rows, float (&largest)[kBorders]) {
    constexpr int kUp = kGridVertices, kLast = kGridCells * kGridVertices;
    constexpr int kFirst[kBorders] = {0, kGridCells, kLast, 0}, kStep[kBorders] = {1, kUp, 1, kUp};
    constexpr int kInside = kBorders * (kGridVertices - 2);
    const Lanes lanes;
    float lines[3][kBorders * kGridVertices];
    for (int axis = 0; axis < 3; ++axis)
        for (int k = 0; k < kGridVertices; ++k)
            for (int b = 0; b < kBorders; ++b)
                lines[axis][kBorders * k + b] = rows.vertices[axis][kFirst[b] + k * kStep[b]];
    float squares[kInside];
    for (int k = 0; k < kInside; k += kWidth) {
        const int here = std::min(k, kInside - kWidth);
        auto squared = hn::Zero(lanes);
        for (const float(&line)[kBorders * kGridVertices] : lines) {
            const float* p = line + here;
            const auto middle = hn::LoadU(lanes, p + kBorders);
            const auto sides = hn::Add(hn::LoadU(lanes, p), hn::LoadU(lanes, p + 2 * kBorders));
            squared = plus_square(squared, hn::Sub(sides, hn::Add(middle, middle)));
        }
        hn::StoreU(squared, lanes, squares + here);
    }
    std::copy_n(squares, kBorders, largest);
    for (int k = kBorders; k < kInside; k += kBorders)
        for (int b = 0; b < kBorders; ++b) largest[b] = std::max(largest[b], squares[k + b]);
}

void measure(const GridRows& rows, GridMeasure& out) {
    measure_box(rows, out);
    measure_borders(rows, out.border);
    const Lanes lanes;
    Differences inner{hn::Zero(lanes), hn::Zero(lanes), hn::Zero(lanes)};
    for (int start = 0; start < kGridCells; start += kWidth) inner.add_columns(rows, start);
    out.uu = std::max({largest_lane(inner.uu), out.border[0], out.border[2]});
    out.vv = std::max({largest_lane(inner.vv), out.border[1], out.border[3]});
    out.uv = largest_lane(inner.uv);
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {
namespace {

HWY_EXPORT(measure);

}  // namespace

GridMeasure measure_grid(const GridRows& rows) {
    GridMeasure result;
    HWY_DYNAMIC_DISPATCH(measure)(rows, result);
    return result;
}

}  // namespace rayleaf
#endif
