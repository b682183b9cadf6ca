#include "tessellation/grid.h"

#include <algorithm>

namespace rayleaf {

Vec3f Grid::vertex(int i, int j) const {
    const int block_i = std::min(i, kGridCells - 1) / kBlockCells, block_j = std::min(j, kGridCells - 1) / kBlockCells;
    const float(&block)[3][kBlockSize] = vertices[block_j * (kGridCells / kBlockCells) + block_i];
    const int index = (j - block_j * kBlockCells) * kBlockVertices + i - block_i * kBlockCells;
    return {block[0][index], block[1][index], block[2][index]};
}

Box3f Grid::box() const {
    Box3f result;
    for (int axis = 0; axis < 3; ++axis) {
        result.min[axis] = *std::min_element(boxes[axis][0], boxes[axis][0] + kBlocks);
        result.max[axis] = *std::max_element(boxes[axis][1], boxes[axis][1] + kBlocks);
    }
    return result;
}

Vec2d grid_parameters(uint32_t triangle, double weight1, double weight2) {
    const uint32_t cell = triangle / 2, column = cell % kGridCells, row = cell / kGridCells;
    const double i = column, j = row;
    return triangle % 2 == 0 ? Vec2d(i + weight1 + weight2, j + weight1) : Vec2d(i + weight2, j + weight1 + weight2);
}

Vec2d parameters_in_cell(uint32_t triangle, double weight1, double weight2) {
    const uint32_t cell = triangle / 2, column = cell % kGridCells, row = cell / kGridCells;
    const Vec2d first(column, row);
    const Vec2d within = grid_parameters(triangle, weight1, weight2) - first;
    return first + Vec2d(std::min(within.x, kBelowOne), std::min(within.y, kBelowOne));
}

GridPlace grid_place(const Vec2d& parameters) {
    const int i = std::clamp(static_cast<int>(parameters.x), 0, kGridCells - 1);
    const int j = std::clamp(static_cast<int>(parameters.y), 0, kGridCells - 1);
    const double s = parameters.x - i, t = parameters.y - j;
    const auto first = static_cast<uint32_t>(2 * (j * kGridCells + i));
    if (s >= t) return {first, t, s - t};
    return {first + 1, t - s, s};
}

}  // namespace rayleaf
