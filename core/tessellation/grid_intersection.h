// A ray against the facets of a grid: SIMD over blocks of 4 x 4 cells.
//
// As in Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection" (JCGT 2013): vertices are moved to the ray's origin
// and sheared so that the ray is the z axis; what side of an edge p q the ray passes is the sign of px qy - py qx.
// Rounding is monotonic, so without fused multiply-add fl(px qy) and fl(py qx) never compare the wrong way round: the
// computed sign is the exact one or zero. Zero counts as inside for the facets on both sides. So with the same sheared
// vertices no ray passes between facets that share an edge or a vertex; a ray through an edge may find both facets.
//
// Grids of fixed-point numbers are tested in double precision. Those of floats are tested in single precision, whose
// error is larger than the relief of small facets. So the test is widened by that error and finds all facets that the
// true ray may hit; FacetRay (geometry/facet.h) decides, by the same steps in double precision.
#pragma once

#include "base/vector.h"
#include "tessellation/grid.h"
#include "tessellation/snapped_grid.h"

#include <cstdint>

namespace rayleaf {

/// Safety factors of the distances to a box's near and far side: (bound - origin) * inverse has four roundings of
/// 2^-24.
inline constexpr float kNearFactor = 1.0f - 0x1p-21f, kFarFactor = 1.0f + 0x1p-21f;

/// A float ray in the form of the kernel. `direction` is unit length; the origin has coordinates of the order of 1.
struct GridRay {
    GridRay() = default;
    GridRay(const Vec3f& ray_origin, const Vec3f& direction);
    /// For grids of fixed-point numbers: the same ray in double, in steps of a length (local units). `direction` has
    /// the length `speed`.
    void set_fixed(const Vec3d& ray_origin, const Vec3d& direction, double speed, double length_of_step);

    float origin[3];                  ///< by axis
    int near_side[3];                 ///< of a box, by axis: 0 where the ray runs towards higher coordinates, else 1
    float inverse_near[3];            ///< kNearFactor / direction; huge where that is zero
    float inverse_far[3];             ///< kFarFactor / direction
    int axis_x, axis_y, axis_z;       ///< axis_z is the direction's largest component
    float shear_x, shear_y, scale_z;  ///< dx/dz, dy/dz, 1/dz
    /// The same for fixed-point numbers, from set_fixed(): the origin in their steps, dx/dz, dy/dz, step/dz.
    double fixed_origin[3], fixed_shear_x, fixed_shear_y, fixed_scale_z;
    float step;
};

/// Error of a corner in the ray's space in single precision, local units, the rounding of the shear included: the same
/// as that of a ray's points at a box (kBlockPadding).
inline constexpr float kCornerError = 0x1p-19f;

/// A facet that the ray may hit.
struct GridCandidate {
    float t;  ///< along the unit direction; for floats that of the nearest corner
    uint32_t triangle;
};

/// All facets of a grid that a ray hits, unordered; nearly always none, one, or the two at an edge. All are found at
/// once, because a ray that leaves a surface finds first the facet that it leaves, and would have to test again.
class GridCandidates {
  public:
    void add(const GridCandidate& candidate) { found_[count_++] = candidate; }
    bool empty() const { return count_ == 0; }
    /// Takes out the nearest; of several the one with the lowest triangle.
    GridCandidate take_nearest() {
        uint32_t nearest = 0;
        for (uint32_t i = 1; i < count_; ++i) {
            const GridCandidate &one = found_[i], &other = found_[nearest];
            if (one.t != other.t ? one.t < other.t : one.triangle < other.triangle) nearest = i;
        }
        const GridCandidate result = found_[nearest];
        found_[nearest] = found_[--count_];
        return result;
    }

  private:
    uint32_t count_ = 0;
    GridCandidate found_[kGridTriangles];  ///< not initialized, to save writing 4 KB per ray and grid
};

/// Blocks of a grid that a ray may hit, and lower bounds of the distance at which it does.
struct NearBlocks {
    uint32_t bits = 0;
    float near[kBlocks];

    bool empty() const { return bits == 0; }
    /// Takes out the nearest; of several the lowest.
    uint32_t take_nearest() {
        auto nearest = static_cast<uint32_t>(__builtin_ctz(bits));
        for (uint32_t left = bits & (bits - 1); left != 0; left &= left - 1) {
            const auto block = static_cast<uint32_t>(__builtin_ctz(left));
            if (near[block] < near[nearest]) nearest = block;
        }
        bits &= ~(1u << nearest);
        return nearest;
    }
};

/// Adds the facets that the ray hits from its origin up to t_max; grids of floats.
using AddCandidates = void (*)(const SnappedGrid& grid, const GridRay& ray, float t_max, GridCandidates& candidates);
/// The blocks of a fine grid whose boxes, enlarged by `padding`, a ray meets up to t_max; one bit each.
using FindBlocks = uint32_t (*)(const Grid& grid, const GridRay& ray, float t_max, float padding);
/// The same without padding, in the order in which the ray comes to them.
using FindNearBlocks = void (*)(const Grid& grid, const GridRay& ray, float t_max, NearBlocks& blocks);
/// Adds the facets of one block of a grid of fixed-point numbers. They are tested in double precision, by the same
/// steps, so the result is exact to about 2^-50 of the shape's size.
using AddBlock = void (*)(const Grid& grid, uint32_t block, const GridRay& ray, float t_max,
                          GridCandidates& candidates);

/// The same for a block alone: vertices by axis, [3][25]. Triangles are numbered 2 * (j * 4 + i), + 1.
using AddBlockOfFloats = void (*)(const float* vertices, const GridRay& ray, float t_max, GridCandidates& candidates);
/// The same of fixed-point numbers, rounded.
using AddBlockOfFixed = void (*)(const int32_t* vertices, const GridRay& ray, float t_max, GridCandidates& candidates);

/// The same for the coarse level.
void add_quad_candidates(const SubpatchDetail& detail, const GridRay& ray, float t_max, GridCandidates& candidates);

struct GridKernels {
    AddCandidates add_candidates;
    FindBlocks find_blocks;
    FindNearBlocks find_near_blocks;
    AddBlock add_block;
    AddBlockOfFloats add_block_of_floats;
    AddBlockOfFixed add_block_of_fixed;
};
/// The versions for this machine's processor.
GridKernels grid_kernels();

}  // namespace rayleaf
