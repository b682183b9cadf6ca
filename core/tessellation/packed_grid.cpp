#include "tessellation/packed_grid.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

namespace rayleaf {
namespace {

/// Arrays of a vertex each are this long, so that loops over them fill vectors.
constexpr int kPadded = 32;

struct alignas(64) Bits {
    int32_t of[kPadded];
};

/// By corner of the grid, for each vertex.
struct BilinearWeights {
    alignas(64) float of[kCorners][kPadded];
};

constexpr BilinearWeights make_weights() {
    BilinearWeights weights{};
    for (int k = 0; k < kBlockSize; ++k) {
        const float u = static_cast<float>(k % kBlockVertices) / kBlockCells;
        const float v = static_cast<float>(k / kBlockVertices) / kBlockCells;
        weights.of[0][k] = (1 - u) * (1 - v);
        weights.of[1][k] = u * (1 - v);
        weights.of[2][k] = (1 - u) * v;
        weights.of[3][k] = u * v;
    }
    return weights;
}
constexpr BilinearWeights kWeights = make_weights();

/// Where the corners lie in the grid.
constexpr std::array<int, kCorners> kCornerVertices = {0, kBlockCells, kBlockSize - kBlockVertices, kBlockSize - 1};

/// Vertices without the corners: three runs.
struct Run {
    int from, to, count;  ///< of the packed ones, of the grid
};
constexpr std::array<Run, 3> kRuns = {{{0, 1, kBlockCells - 1},
                                       {kBlockCells - 1, kBlockVertices, kBlockSize - 2 * kBlockVertices},
                                       {kBlockSize - kBlockVertices - 2, kBlockSize - kBlockCells, kBlockCells - 1}}};

/// The bilinear patch of the corners.
void predict(const float (&corners)[kCorners], Bits& bits) {
    alignas(64) float values[kPadded];
    for (int k = 0; k < kPadded; ++k)
        values[k] = (corners[0] * kWeights.of[0][k] + corners[1] * kWeights.of[1][k]) +
                    (corners[2] * kWeights.of[2][k] + corners[3] * kWeights.of[3][k]);
    std::memcpy(bits.of, values, sizeof values);
}

}  // namespace

bool pack(const MediumGrid& grid, const SubpatchDetail& detail, PackedGrid& packed) {
    for (int axis = 0; axis < 3; ++axis) {
        const float* vertices = grid.vertices[axis];
        for (int c = 0; c < kCorners; ++c)
            if (vertices[kCornerVertices[c]] != detail.corners[axis][c]) return false;
        Bits predicted;
        predict(detail.corners[axis], predicted);
        int32_t bits[kBlockSize];
        std::memcpy(bits, vertices, sizeof bits);
        for (const Run& run : kRuns) {
            for (int i = 0; i < run.count; ++i) {
                const int64_t step = int64_t{bits[run.to + i]} - predicted.of[run.to + i];
                using Limits = std::numeric_limits<int16_t>;
                if (step < Limits::min() || step > Limits::max()) return false;
                packed.steps[axis][run.from + i] = static_cast<int16_t>(step);
            }
        }
    }
    return true;
}

void unpack(const PackedGrid& packed, const SubpatchDetail& detail, MediumGrid& grid) {
    for (int axis = 0; axis < 3; ++axis) {
        alignas(64) int16_t steps[kPadded] = {};
        for (const Run& run : kRuns)
            std::memcpy(steps + run.to, packed.steps[axis] + run.from, run.count * sizeof(int16_t));
        Bits bits;
        predict(detail.corners[axis], bits);
        for (int k = 0; k < kPadded; ++k) bits.of[k] += steps[k];
        std::memcpy(grid.vertices[axis], bits.of, sizeof grid.vertices[axis]);
        for (int c = 0; c < kCorners; ++c) grid.vertices[axis][kCornerVertices[c]] = detail.corners[axis][c];
    }
}

}  // namespace rayleaf
