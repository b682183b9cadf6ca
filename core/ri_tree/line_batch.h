// Sixteen rays at a time for the fast tree: rays to lines, lines to places in cells, leaves to values; with SIMD.
//
// All lanes do the same operations in the same order, without fused multiply-add, and so does a single ray. So a ray's
// answer depends neither on the instruction set nor on the other rays of its batch.
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

/// The numbers of the object that a batch needs.
struct BatchFrame {
    Vec3d center{0, 0, 0};  ///< local = (object - center) * shrink
    double shrink = 1;
    Vec3d box_min{0, 0, 0}, box_max{0, 0, 0}, box_center{0, 0, 0};      ///< local
    std::array<std::array<double, kLineAxes>, 3> inverse_half_sides{};  ///< of the root cell, by dominant axis
};

/// Number of bits of a place along a line axis.
inline constexpr int kPlaceBits = 31;

/// The lines of up to sixteen rays, local space; indexed by line axis or coordinate, then by ray.
struct alignas(64) LineBatch {
    int32_t line_direction[kBatchRays];
    int32_t place[kLineAxes][kBatchRays];  ///< share of the root cell, times 2^kPlaceBits
    double intercept[2][kBatchRays];       ///< with the middle plane, relative to the box's middle
    double slope[2][kBatchRays];
    double direction[3][kBatchRays];  ///< unit
    RaySet rays = 0;                  ///< the valid ones
    RaySet in_box = 0;                ///< those of them that enter the box or start inside
    RaySet inside = 0;                ///< those of them that start inside
};

/// A cell in the form that lanes are compared with.
struct CellPlace {
    std::array<int32_t, kLineAxes> first{};  ///< lowest place
    std::array<int32_t, kLineAxes> bits{};   ///< places along an axis: 2^bits
};

struct BatchFunctions {
    /// Prepares `count` rays, 1 to kBatchRays.
    void (*prepare)(const Ray* rays, int count, const BatchFrame& frame, LineBatch& batch);
    /// The rays of a direction that are in a cell.
    RaySet (*rays_in)(const LineBatch& batch, int line_direction, const CellPlace& cell);
    /// The leaf's values for all rays; those of rays outside the cell are meaningless.
    void (*evaluate)(const LineBatch& batch, const CellPlace& cell, const CellLeaf& leaf, float (*values)[kBatchRays]);
    /// The same for one ray; `values` has room for kLeafPadding.
    void (*evaluate_one)(const LineBatch& batch, int ray, const CellPlace& cell, const CellLeaf& leaf, float* values);
    /// Derivatives of one ray's values along a step of the cell's coordinates; `changes` has room for kLeafPadding.
    void (*differentiate)(const LineBatch& batch, int ray, const CellPlace& cell, const CellLeaf& leaf,
                          const float (&step)[kLineAxes], float* changes);
};
/// The versions for this machine's processor.
BatchFunctions batch_functions();

}  // namespace rayleaf
