#include "tessellation/grid.h"

#include <algorithm>

namespace rayleaf {

FacetCorners Grid::corners(uint32_t triangle) const {
    const auto cell = static_cast<int>(triangle / 2);
    const int low = cell / kGridCells * kGridVertices + cell % kGridCells, high = low + kGridVertices + 1;
    const bool upper = triangle % 2 != 0;
    return {Vec3d(vertex(low)), Vec3d(vertex(upper ? high - 1 : high)), Vec3d(vertex(upper ? high : low + 1))};
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
    const uint32_t cell = triangle / 2;
    const double i = cell % kGridCells, j = cell / kGridCells;
    return triangle % 2 == 0 ? Vec2d(i + weight1 + weight2, j + weight1) : Vec2d(i + weight2, j + weight1 + weight2);
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
