#include "ri_tree/corner_weights.h"

#include <cmath>
#include <utility>

namespace rayleaf {
namespace {

/// Unknowns of an affine function of four variables.
constexpr int kAffine = kLineAxes + 1;
/// Pivots of the corners' Gram matrix are rationals with small denominators, or zero up to rounding.
constexpr double kLeastPivot = 1e-9;

using AffineVector = std::array<double, kAffine>;
using AffineMatrix = std::array<AffineVector, kAffine>;

/// The vector (1, x) of a corner, with the cell as [-1, 1]^4.
AffineVector affine_corner(int corner) {
    AffineVector row{};
    row[0] = 1.0;
    for (int k = 0; k < kLineAxes; ++k) row[k + 1] = ((corner >> k) & 1) != 0 ? 1.0 : -1.0;
    return row;
}

/// Solves by elimination, pivoting on the largest diagonal element; empty if the matrix is singular.
std::optional<AffineVector> solve(AffineMatrix matrix, AffineVector right) {
    for (int column = 0; column < kAffine; ++column) {
        int pivot = column;
        for (int row = column + 1; row < kAffine; ++row)
            if (std::abs(matrix[row][column]) > std::abs(matrix[pivot][column])) pivot = row;
        if (std::abs(matrix[pivot][column]) < kLeastPivot) return std::nullopt;
        std::swap(matrix[pivot], matrix[column]);
        std::swap(right[pivot], right[column]);
        for (int row = column + 1; row < kAffine; ++row) {
            const double factor = matrix[row][column] / matrix[column][column];
            for (int k = column; k < kAffine; ++k) matrix[row][k] -= factor * matrix[column][k];
            right[row] -= factor * right[column];
        }
    }
    for (int row = kAffine - 1; row >= 0; --row) {
        for (int k = row + 1; k < kAffine; ++k) right[row] -= matrix[row][k] * right[k];
        right[row] /= matrix[row][row];
    }
    return right;
}

}  // namespace

CornerWeights quadrilinear_weights(const std::array<double, kLineAxes>& position) {
    CornerWeights weights{};
    for (int corner = 0; corner < kCellCorners; ++corner) {
        double weight = 1.0;
        for (int k = kLineAxes - 1; k >= 0; --k) weight *= ((corner >> k) & 1) != 0 ? position[k] : 1.0 - position[k];
        weights[corner] = weight;
    }
    return weights;
}

std::optional<CornerWeights> affine_weights(CornerSet usable, const std::array<double, kLineAxes>& position) {
    AffineMatrix gram{};
    for (int corner = 0; corner < kCellCorners; ++corner) {
        if (((usable >> corner) & 1) == 0) continue;
        const AffineVector row = affine_corner(corner);
        for (int i = 0; i < kAffine; ++i)
            for (int j = 0; j < kAffine; ++j) gram[i][j] += row[i] * row[j];
    }
    AffineVector wanted{1.0, 0.0, 0.0, 0.0, 0.0};
    for (int k = 0; k < kLineAxes; ++k) wanted[k + 1] = 2.0 * position[k] - 1.0;
    const std::optional<AffineVector> multipliers = solve(gram, wanted);
    if (!multipliers) return std::nullopt;
    CornerWeights weights{};
    for (int corner = 0; corner < kCellCorners; ++corner) {
        if (((usable >> corner) & 1) == 0) continue;
        const AffineVector row = affine_corner(corner);
        for (int i = 0; i < kAffine; ++i) weights[corner] += row[i] * (*multipliers)[i];
    }
    return weights;
}

}  // namespace rayleaf
