#include "tessellation/packed_grid.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

namespace rayleaf {
namespace {

/// Length of arrays with one number per vertex, so that loops over them fill SIMD vectors.
constexpr int kPadded = 32;

struct alignas(64) Bits {
    int32_t of[kPadded];
};

/// Bilinear weights by corner of the grid, for each vertex.
struct BilinearWeights {
    alignas(64) float of[kCorners][kPadded];
};

constexpr BilinearWeights make_weights() {
    BilinearWeights weights{};
    for (int k = 0; k < kBlockSize; ++k) {
        const float u = static_cast<float>(k % kBlockVertices) / kBlockCells;
        const int row = k / kBlockVertices;
        const float v = static_cast<float>(row) / kBlockCells;
        weights.of[0][k] = (1 - u) * (1 - v);
        weights.of[1][k] = u * (1 - v);
        weights.of[2][k] = (1 - u) * v;
        weights.of[3][k] = u * v;
    }
    return weights;
}
constexpr BilinearWeights kWeights = make_weights();

/// Indices of the corners in the grid.
constexpr std::array<int, kCorners> kCornerVertices = {0, kBlockCells, kBlockSize - kBlockVertices, kBlockSize - 1};

/// The vertices without the corners: three runs.
struct Run {
    int from, to, count;  ///< indices: packed, in the grid
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

/// Of the 3 x 3 vertices that are stored first, those that are no corners.
constexpr std::array<int, SmoothGrid::kMiddles> kMiddleVertices = {2, 10, 12, 14, 22};
/// All others.
constexpr std::array<int, SmoothGrid::kOthers> kOtherVertices = {1,  3,  5,  6,  7,  8,  9,  11,
                                                                 13, 15, 16, 17, 18, 19, 21, 23};

/// Weights of the parabola through three values at a quarter and three quarters of the way between the outer ones.
constexpr float kNear = 0.375f, kMiddle = 0.75f, kFar = -0.125f;

/// Predicts by the biquadratic patch through every other vertex, which are already in the grid.
void predict_from_known(float* vertices) {
    for (int j = 0; j < kBlockVertices; j += 2) {
        float* row = vertices + j * kBlockVertices;
        row[1] = (kNear * row[0] + kMiddle * row[2]) + kFar * row[4];
        row[3] = (kNear * row[4] + kMiddle * row[2]) + kFar * row[0];
    }
    const float *low = vertices, *middle = low + 2 * kBlockVertices, *high = middle + 2 * kBlockVertices;
    for (int i = 0; i < kBlockVertices; ++i) {
        vertices[kBlockVertices + i] = (kNear * low[i] + kMiddle * middle[i]) + kFar * high[i];
        vertices[3 * kBlockVertices + i] = (kNear * high[i] + kMiddle * middle[i]) + kFar * low[i];
    }
}

bool fits(int64_t step) {
    using Limits = std::numeric_limits<int16_t>;
    return step >= Limits::min() && step <= Limits::max();
}

bool has_corners(const MediumGrid& grid, const SubpatchDetail& detail) {
    for (int axis = 0; axis < 3; ++axis)
        for (int c = 0; c < kCorners; ++c)
            if (grid.vertices[axis][kCornerVertices[c]] != detail.corners[axis][c]) return false;
    return true;
}

/// The differences of the other vertices, in 5 bits.
constexpr int kStepBits = 5, kStepBias = 1 << (kStepBits - 1);
constexpr unsigned kStepMask = (1u << kStepBits) - 1;

}  // namespace

bool pack(const MediumGrid& grid, const SubpatchDetail& detail, PackedGrid& packed) {
    if (!has_corners(grid, detail)) return false;
    for (int axis = 0; axis < 3; ++axis) {
        const float* vertices = grid.vertices[axis];
        Bits predicted;
        predict(detail.corners[axis], predicted);
        int32_t bits[kBlockSize];
        std::memcpy(bits, vertices, sizeof bits);
        for (const Run& run : kRuns) {
            for (int i = 0; i < run.count; ++i) {
                const int64_t step = int64_t{bits[run.to + i]} - predicted.of[run.to + i];
                if (!fits(step)) return false;
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

bool pack(const MediumGrid& grid, const SubpatchDetail& detail, SmoothGrid& packed) {
    if (!has_corners(grid, detail)) return false;
    std::fill_n(packed.others, SmoothGrid::kOthers, uint16_t{0});
    for (int axis = 0; axis < 3; ++axis) {
        Bits predicted;
        predict(detail.corners[axis], predicted);
        int32_t bits[kBlockSize];
        std::memcpy(bits, grid.vertices[axis], sizeof bits);
        for (int i = 0; i < SmoothGrid::kMiddles; ++i) {
            const int64_t step = int64_t{bits[kMiddleVertices[i]]} - predicted.of[kMiddleVertices[i]];
            if (!fits(step)) return false;
            packed.middles[axis][i] = static_cast<int16_t>(step);
        }
        float vertices[kBlockSize];
        std::copy_n(grid.vertices[axis], kBlockSize, vertices);
        predict_from_known(vertices);
        std::memcpy(predicted.of, vertices, sizeof vertices);
        for (int i = 0; i < SmoothGrid::kOthers; ++i) {
            const int64_t step = int64_t{bits[kOtherVertices[i]]} - predicted.of[kOtherVertices[i]] + kStepBias;
            if (step < 0 || step > int64_t{kStepMask}) return false;
            packed.others[i] = static_cast<uint16_t>(packed.others[i] | step << (kStepBits * axis));
        }
    }
    return true;
}

void unpack(const SmoothGrid& packed, const SubpatchDetail& detail, MediumGrid& grid) {
    for (int axis = 0; axis < 3; ++axis) {
        Bits bits;
        predict(detail.corners[axis], bits);
        for (int i = 0; i < SmoothGrid::kMiddles; ++i) bits.of[kMiddleVertices[i]] += packed.middles[axis][i];
        float* vertices = grid.vertices[axis];
        std::memcpy(vertices, bits.of, sizeof grid.vertices[axis]);
        for (int c = 0; c < kCorners; ++c) vertices[kCornerVertices[c]] = detail.corners[axis][c];
        predict_from_known(vertices);
        std::memcpy(bits.of, vertices, sizeof grid.vertices[axis]);
        for (int i = 0; i < SmoothGrid::kOthers; ++i) {
            const unsigned step = static_cast<unsigned>(packed.others[i]) >> (kStepBits * axis) & kStepMask;
            bits.of[kOtherVertices[i]] += static_cast<int32_t>(step) - kStepBias;
        }
        std::memcpy(vertices, bits.of, sizeof grid.vertices[axis]);
    }
}

}  // namespace rayleaf
