// A ray against the facets of a grid in steps.
//
// Single precision finds the cells of a block that the ray may pass through, all sixteen at once, with a margin for
// rounding. The edge functions of their triangles are then computed in double precision from integer numbers of steps,
// by the same operations in every grid (grid_intersection.h), and an edge belongs to the facets on both sides. So no
// ray passes between facets, and results do not depend on the processor.
#pragma once

#include "tessellation/grid_intersection.h"
#include "tessellation/step_grid.h"

#include <cstdint>

namespace rayleaf {

/// A ray relative to a grid in steps, in units of these: the point where it crosses the plane through the grid's corner
/// at right angles to axis_z, relative to that corner.
struct StepRay {
    StepRay(const StepGrid& grid, const GridRay& ray);

    int axis_x, axis_y, axis_z;
    float x, y, shear_x, shear_y;
};

/// The blocks whose boxes the ray meets up to t_max.
using FindNearSteps = void (*)(const StepGrid& grid, const GridRay& ray, float t_max, NearBlocks& blocks);
/// The triangles of a block that the ray may hit: a bit for the lower one of each cell, row by row, then the upper
/// ones.
using FindStepTriangles = uint32_t (*)(const StepGrid& grid, uint32_t block, const StepRay& ray);

struct StepKernels {
    FindNearSteps find_near_blocks;
    FindStepTriangles find_triangles;
};
/// The versions for this machine's processor.
StepKernels step_kernels();

/// The number of a triangle by its block and its bit there.
inline uint32_t step_triangle(uint32_t block, uint32_t bit) {
    constexpr uint32_t kCells = kBlockCells * kBlockCells;
    const uint32_t cell = bit % kCells, row = block / kBlocksAlong * kBlockCells + cell / kBlockCells;
    return 2 * (row * kGridCells + block % kBlocksAlong * kBlockCells + cell % kBlockCells) + bit / kCells;
}

/// Whether the ray's line passes through a triangle, its edges included.
bool passes(const StepGrid& grid, uint32_t triangle, const GridRay& ray);

}  // namespace rayleaf
