// The facets of one subpatch: 17 x 17 vertices in local space, and the boxes of its 16 blocks of 4 x 4 cells.
//
// Vertex (i, j) is at index j * 17 + i; i runs along u. Cell (i, j) is cut by the diagonal from vertex (i, j) to
// (i+1, j+1); its triangle 2 * (j * 16 + i) has the corners (i,j), (i+1,j+1), (i+1,j), the next one (i,j), (i,j+1),
// (i+1,j+1): counter-clockwise seen from the outside, the side of P_v x P_u.
#pragma once

#include "base/vector.h"
#include "geometry/facet.h"

#include <cstdint>

namespace rayleaf {

inline constexpr int kGridCells = 16;
inline constexpr int kGridVertices = kGridCells + 1;  ///< along one side
inline constexpr int kGridSize = kGridVertices * kGridVertices;
inline constexpr int kBlockCells = 4;
inline constexpr int kBlocks = (kGridCells / kBlockCells) * (kGridCells / kBlockCells);
inline constexpr uint32_t kGridTriangles = 2 * kGridCells * kGridCells;

/// What a block's box is enlarged by beyond its vertices, local units: what a float ray's points may be off (the
/// derivation is at kBoxPadding in trace/local_ray.h).
inline constexpr float kBlockPadding = 0x1p-20f;

struct alignas(64) Grid {
    /// By axis. The kernels read up to a vector's width past the last vertex.
    float vertices[3][kGridSize + 15];
    /// Padded boxes of the blocks: by axis, low then high, block 4 * (j / 4) + i / 4.
    float boxes[3][2][kBlocks];

    Vec3f vertex(int index) const { return {vertices[0][index], vertices[1][index], vertices[2][index]}; }
    FacetCorners corners(uint32_t triangle) const;
    /// Box of all vertices, padded as the blocks' are.
    Box3f box() const;
};

/// Where in a grid a point of a triangle lies: i + fraction, j + fraction.
Vec2d grid_parameters(uint32_t triangle, double weight1, double weight2);

/// The triangle of a grid at grid parameters in [0,16]², and the weights of its corners 1 and 2.
struct GridPlace {
    uint32_t triangle = 0;
    double weight1 = 0, weight2 = 0;
};
GridPlace grid_place(const Vec2d& parameters);

}  // namespace rayleaf
