#include "tessellation/step_grid.h"

#include <algorithm>

namespace rayleaf {

FacetCorners StepGrid::corners(uint32_t triangle, double step) const {
    const BlockTriangle at = block_triangle(triangle);
    FacetCorners result;
    for (int k = 0; k < 3; ++k)
        for (int axis = 0; axis < 3; ++axis)
            result[k][axis] = (corner[axis] + vertices[at.block][axis][at.vertices[k]]) * step;
    return result;
}

void pack(const Grid& grid, int shift, StepGrid& steps) {
    for (int axis = 0; axis < 3; ++axis) {
        int32_t low = grid.fixed[0][axis][0];
        for (const int32_t(&block)[3][kBlockSize] : grid.fixed)
            low = std::min(low, *std::min_element(block[axis], block[axis] + kBlockSize));
        steps.corner[axis] = low >> shift;
        for (int block = 0; block < kBlocks; ++block) {
            uint16_t* out = steps.vertices[block][axis];
            for (int k = 0; k < kBlockSize; ++k)
                out[k] = static_cast<uint16_t>((grid.fixed[block][axis][k] >> shift) - steps.corner[axis]);
            const auto [least, most] = std::minmax_element(out, out + kBlockSize);
            steps.boxes[axis][0][block] = *least;
            steps.boxes[axis][1][block] = *most;
        }
    }
    std::fill(std::begin(steps.beyond), std::end(steps.beyond), uint16_t{0});
}

}  // namespace rayleaf
