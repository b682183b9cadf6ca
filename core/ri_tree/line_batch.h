// Sixteen rays at a time for the fast tree: rays to lines, lines to places in cells, leaves to values; with SIMD.
//
// All lanes do the same operations in the same order, none a fused multiply-add, and a ray by itself goes through them
// too. So neither the instruction set nor the company of a ray shows in its answer.
#pragma once

#include "rays/ray.h"
#include "ri_tree/cell_leaf.h"
#include "ri_tree/line_space.h"
#include "ri_tree/ray_cache.h"

#include <array>
#include <cstdint>

namespace rayleaf {

inline constexpr int kBatchRays = 16;
using RaySet = uint16_t;  ///< bit i: ray i of a batch

/// What a batch needs to know of the object.
struct BatchFrame {
    Vec3d center{0, 0, 0};  ///< local = (object - center) * shrink
    double shrink = 1;
    Vec3d box_min{0, 0, 0}, box_max{0, 0, 0}, box_center{0, 0, 0};      ///< local
    std::array<std::array<double, kLineAxes>, 3> inverse_half_sides{};  ///< of the root cell, by dominant axis
};

/// Places along a line axis are integers of so many bits.
inline constexpr int kPlaceBits = 31;

/// Lines of up to sixteen rays, local space; by line axis or coordinate first, then by ray.
struct alignas(64) LineBatch {
    int32_t line_direction[kBatchRays];
    int32_t place[kLineAxes][kBatchRays];  ///< share of the root cell, times 2^kPlaceBits
    double intercept[2][kBatchRays];       ///< with the middle plane, relative to the box's middle
    double slope[2][kBatchRays];
    double direction[3][kBatchRays];  ///< unit
    RaySet rays = 0;                  ///< those that are rays
    RaySet in_box = 0;                ///< of them: enter the box, or start inside
    RaySet inside = 0;                ///< of them: start inside
};

/// A cell as lanes are compared with it.
struct CellPlace {
    std::array<int32_t, kLineAxes> first{};  ///< lowest place
    std::array<int32_t, kLineAxes> bits{};   ///< places along an axis: 2^bits
};

struct BatchFunctions {
    /// Of `count` rays, 1 to kBatchRays.
    void (*prepare)(const Ray* rays, int count, const BatchFrame& frame, LineBatch& batch);
    /// The rays of a direction that are in a cell.
    RaySet (*rays_in)(const LineBatch& batch, int line_direction, const CellPlace& cell);
    /// The leaf's values for all rays; what stands for rays outside the cell means nothing.
    void (*evaluate)(const LineBatch& batch, const CellPlace& cell, const CellLeaf& leaf, float (*values)[kBatchRays]);
    /// For one ray; `values` has room for kLeafPadding.
    void (*evaluate_one)(const LineBatch& batch, int ray, const CellPlace& cell, const CellLeaf& leaf, float* values);
    /// How the values of one ray change with a step of the cell's coordinates; `changes` has room for kLeafPadding.
    void (*differentiate)(const LineBatch& batch, int ray, const CellPlace& cell, const CellLeaf& leaf,
                          const float (&step)[kLineAxes], float* changes);
};
/// The versions for this machine's processor.
BatchFunctions batch_functions();

}  // namespace rayleaf
