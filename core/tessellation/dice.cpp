#include "tessellation/dice.h"

#include "base/simd.h"

#include <algorithm>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tessellation/dice.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef RAYLEAF_DICE_TYPES
#define RAYLEAF_DICE_TYPES
namespace rayleaf {

/// A subpatch as the kernel reads it: control points in float, by component, u fastest.
struct DiceTask {
    int degree_u, degree_v;
    int components;  ///< 3, or 4 for homogeneous points
    float control[4][(kMostDicedDegree + 1) * (kMostDicedDegree + 1)];
    const DyadicBasis *basis_u, *basis_v;
    int first_u, first_v;
    float* out[3];  ///< by axis, rows along u
};

}  // namespace rayleaf
#endif

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// How 16 or 4 cells along a side are divided into vectors.
template <int kCells>
struct Row {
    using Lanes = hn::CappedTag<float, kCells>;
    using Vector = hn::Vec<Lanes>;
    static constexpr int kVertices = kCells + 1;
    static constexpr int kWidth = static_cast<int>(hn::MaxLanes(Lanes()));
    /// Where the vectors that cover the vertices start; the last one overlaps.
    static constexpr int kChunks = kCells / kWidth + 1;
    static constexpr int chunk_start(int chunk) { return chunk + 1 < kChunks ? chunk * kWidth : kVertices - kWidth; }
};

using Lanes = Row<kGridCells>::Lanes;
using Vector = Row<kGridCells>::Vector;
constexpr int kWidth = Row<kGridCells>::kWidth;

/// The sum (t0 + tn) + (t1 + tn-1) + ... + the middle term.
template <typename Term>
HWY_INLINE auto symmetric_sum(int degree, const Term& term) {
    auto sum = hn::Add(term(0), term(degree));
    for (int i = 1; i < degree - i; ++i) sum = hn::Add(sum, hn::Add(term(i), term(degree - i)));
    return degree % 2 == 0 ? hn::Add(sum, term(degree / 2)) : sum;
}

/// Control points of the iso-curves v = const: rows[component][i][row].
struct CurvePoints {
    float rows[4][kMostDicedDegree + 1][kGridVertices + 15];
};

template <int kCells>
HWY_INLINE void evaluate_along_v(const DiceTask& task, int degree_v, CurvePoints& curves) {
    const typename Row<kCells>::Lanes lanes;
    const int columns = task.degree_u + 1;
    for (int chunk = 0; chunk < Row<kCells>::kChunks; ++chunk) {
        const int start = Row<kCells>::chunk_start(chunk);
        for (int c = 0; c < task.components; ++c) {
            for (int i = 0; i < columns; ++i) {
                const float* control = &task.control[c][i];
                const auto sum = symmetric_sum(degree_v, [&](int j) HWY_ATTR {
                    return hn::Mul(hn::LoadU(lanes, task.basis_v->values(j, task.first_v + start)),
                                   hn::Set(lanes, control[j * columns]));
                });
                hn::StoreU(sum, lanes, &curves.rows[c][i][start]);
            }
        }
    }
}

/// Sums up points in lanes; `term` makes the terms of a component.
template <typename Points, typename Term>
HWY_INLINE void sum_points(int components, int degree, const Term& term, Points (&points)[3]) {
    for (int c = 0; c < 3; ++c) points[c] = symmetric_sum(degree, [&](int i) HWY_ATTR { return term(c, i); });
    if (components < 4) return;
    const auto w = symmetric_sum(degree, [&](int i) HWY_ATTR { return term(3, i); });
    for (Points& axis : points) axis = hn::Div(axis, w);
}

/// The vertices of all rows but their last.
template <int kCells>
HWY_INLINE void evaluate_rows(const DiceTask& task, int degree_u, const CurvePoints& curves) {
    const typename Row<kCells>::Lanes lanes;
    for (int row = 0; row < Row<kCells>::kVertices; ++row) {
        for (int start = 0; start < kCells; start += Row<kCells>::kWidth) {
            typename Row<kCells>::Vector points[3];
            const auto term = [&](int c, int i) HWY_ATTR {
                return hn::Mul(hn::LoadU(lanes, task.basis_u->values(i, task.first_u + start)),
                               // NOLINTNEXTLINE(clang-analyzer-core.CallAndMessage): evaluate_along_v filled it
                               hn::Set(lanes, curves.rows[c][i][row]));
            };
            sum_points(task.components, degree_u, term, points);
            for (int axis = 0; axis < 3; ++axis)
                hn::StoreU(points[axis], lanes, task.out[axis] + row * Row<kCells>::kVertices + start);
        }
    }
}

/// The last vertices of all rows.
template <int kCells>
HWY_INLINE void evaluate_last_column(const DiceTask& task, int degree_u, const CurvePoints& curves) {
    const typename Row<kCells>::Lanes lanes;
    for (int chunk = 0; chunk < Row<kCells>::kChunks; ++chunk) {
        const int start = Row<kCells>::chunk_start(chunk);
        typename Row<kCells>::Vector points[3];
        const auto term = [&](int c, int i) HWY_ATTR {
            return hn::Mul(hn::Set(lanes, *task.basis_u->values(i, task.first_u + kCells)),
                           hn::LoadU(lanes, &curves.rows[c][i][start]));
        };
        sum_points(task.components, degree_u, term, points);
        for (int axis = 0; axis < 3; ++axis) {
            HWY_ALIGN float column[Row<kCells>::kWidth];
            hn::Store(points[axis], lanes, column);
            for (int k = 0; k < Row<kCells>::kWidth; ++k)
                task.out[axis][(start + k) * Row<kCells>::kVertices + kCells] = column[k];
        }
    }
}

template <int kCells>
HWY_INLINE void evaluate_along_u(const DiceTask& task, int degree_u, const CurvePoints& curves) {
    evaluate_rows<kCells>(task, degree_u, curves);
    evaluate_last_column<kCells>(task, degree_u, curves);
}

template <int kCells>
HWY_INLINE void evaluate_grid(const DiceTask& task) {
    CurvePoints curves;
    // The common degree as a constant lets the compiler unroll the sums.
    if (task.degree_v == 3)
        evaluate_along_v<kCells>(task, 3, curves);
    else
        evaluate_along_v<kCells>(task, task.degree_v, curves);
    if (task.degree_u == 3)
        evaluate_along_u<kCells>(task, 3, curves);
    else
        evaluate_along_u<kCells>(task, task.degree_u, curves);
}

void evaluate(const DiceTask& task, int cells) {
    if (cells == kGridCells)
        evaluate_grid<kGridCells>(task);
    else
        evaluate_grid<kBlockCells>(task);
}

/// Smallest or largest (by `pick`) of each group of four lanes, in all four of them; a single lane stays as it is.
template <typename Pick>
HWY_INLINE Vector reduce_groups(Vector v, [[maybe_unused]] const Pick& pick) {
#if HWY_TARGET != HWY_SCALAR
    v = pick(v, hn::Shuffle2301(v));
    v = pick(v, hn::Shuffle1032(v));
#endif
    return v;
}

/// Smallest or largest (by `pick`) of each block's 25 vertices. Columns 0..15 and 1..16 together reach every vertex of
/// a block; within a block, the four columns are one group of four lanes.
template <typename Pick>
HWY_INLINE void reduce_blocks(const float* vertices, const Pick& pick, float padding, float* out) {
    const Lanes lanes;
    for (int band = 0; band < kGridCells / kBlockCells; ++band) {
        HWY_ALIGN float columns[kGridCells];
        for (int start = 0; start < kGridCells; start += kWidth) {
            const float* first = vertices + band * kBlockCells * kGridVertices + start;
            Vector best = pick(hn::LoadU(lanes, first), hn::LoadU(lanes, first + 1));
            for (int row = 1; row <= kBlockCells; ++row) {
                const float* here = first + row * kGridVertices;
                best = pick(best, pick(hn::LoadU(lanes, here), hn::LoadU(lanes, here + 1)));
            }
            hn::Store(reduce_groups(best, pick), lanes, columns + start);
        }
        for (int block = 0; block < kGridCells / kBlockCells; ++block) {
            const float* group = columns + block * kBlockCells;
            float best = group[0];
            if constexpr (kWidth == 1) {
                const hn::CappedTag<float, 1> one;
                for (int i = 1; i < kBlockCells; ++i)
                    best = hn::GetLane(pick(hn::Set(one, best), hn::Set(one, group[i])));
            }
            out[(kGridCells / kBlockCells) * band + block] = best + padding;
        }
    }
}

void pack_rows(const GridRows& rows, Grid& grid) {
    for (int axis = 0; axis < 3; ++axis) {
        const float* vertices = rows.vertices[axis];
        reduce_blocks(
            vertices, [](Vector a, Vector b) HWY_ATTR { return hn::Min(a, b); }, -kBlockPadding, grid.boxes[axis][0]);
        reduce_blocks(
            vertices, [](Vector a, Vector b) HWY_ATTR { return hn::Max(a, b); }, kBlockPadding, grid.boxes[axis][1]);
        for (int block = 0; block < kBlocks; ++block) {
            const int row = block / kBlockCells * kBlockCells, column = block % kBlockCells * kBlockCells;
            for (int j = 0; j < kBlockVertices; ++j)
                std::memcpy(&grid.vertices[block][axis][j * kBlockVertices],
                            vertices + (row + j) * kGridVertices + column, kBlockVertices * sizeof(float));
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {
namespace {

HWY_EXPORT(evaluate);
HWY_EXPORT(pack_rows);

void prepare(const PatchView& patch, DiceTask& task) {
    task.degree_u = patch.degree_u;
    task.degree_v = patch.degree_v;
    task.components = patch.rational ? 4 : 3;
    for (int j = 0, k = 0; j < patch.rows(); ++j)
        for (int i = 0; i < patch.columns(); ++i, ++k)
            for (int c = 0; c < task.components; ++c) task.control[c][k] = static_cast<float>(patch.point(i, j)[c]);
}

Vec3f float_position(const PatchView& patch, int i, int j) {
    const Vec4d& p = patch.point(i, j);
    return patch.rational ? Vec3f(Vec3d(p.x / p.w, p.y / p.w, p.z / p.w)) : Vec3f(Vec3d(p.x, p.y, p.z));
}

/// A border whose control points coincide: evaluation would move its vertices off the point by rounding.
struct Border {
    int i, j;            ///< its first control point
    int step_i, step_j;  ///< to the next
    int count;
};

bool is_point(const PatchView& patch, const Border& border) {
    const Vec3f first = float_position(patch, border.i, border.j);
    for (int k = 1; k < border.count; ++k)
        if (float_position(patch, border.i + k * border.step_i, border.j + k * border.step_j) != first) return false;
    return true;
}

/// Sets the vertices of borders that are points.
void set_collapsed_borders(const PatchView& patch, const DiceAxis& u, const DiceAxis& v, const VertexRows& target) {
    const int vertices = target.quads + 1, last_row = target.quads * vertices;
    const auto fix = [&](const Border& border, int first, int stride) {
        if (!is_point(patch, border)) return;
        const Vec3f point = float_position(patch, border.i, border.j);
        for (int k = 0; k < vertices; ++k)
            for (int axis = 0; axis < 3; ++axis) target.axes[axis][first + k * stride] = point[axis];
    };
    if (u.at_begin) fix({0, 0, 0, 1, patch.rows()}, 0, vertices);
    if (u.at_end) fix({patch.degree_u, 0, 0, 1, patch.rows()}, target.quads, vertices);
    if (v.at_begin) fix({0, 0, 1, 0, patch.columns()}, 0, 1);
    if (v.at_end) fix({0, patch.degree_v, 1, 0, patch.columns()}, last_row, 1);
}

}  // namespace

void dice(const PatchView& patch, const DiceAxis& u, const DiceAxis& v, const VertexRows& target) {
    DiceTask task;
    prepare(patch, task);
    task.basis_u = u.basis;
    task.basis_v = v.basis;
    task.first_u = u.first;
    task.first_v = v.first;
    std::copy_n(target.axes, 3, task.out);
    HWY_DYNAMIC_DISPATCH(evaluate)(task, target.quads);
    set_collapsed_borders(patch, u, v, target);
}

void pack(const GridRows& rows, Grid& grid) {
    HWY_DYNAMIC_DISPATCH(pack_rows)(rows, grid);
}

}  // namespace rayleaf
#endif
