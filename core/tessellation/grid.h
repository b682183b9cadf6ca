// The facets of one subpatch: 17 x 17 vertices in local space, and the boxes of its 16 blocks of 4 x 4 cells.
//
// Cell (i, j) lies between the vertices (i, j) and (i+1, j+1), i along u, and is cut by the diagonal between them. Its
// triangle 2 * (j * 16 + i) has the corners (i,j), (i+1,j+1), (i+1,j), the next one (i,j), (i,j+1), (i+1,j+1):
// counter-clockwise seen from the outside, the side of P_v x P_u.
//
// Each block has its own copy of its 5 x 5 vertices, so that testing it reads few cache lines.
#pragma once

#include "base/vector.h"
#include "geometry/facet.h"

#include <cstdint>

namespace rayleaf {

inline constexpr int kGridCells = 16;
inline constexpr int kGridVertices = kGridCells + 1;  ///< along one side
inline constexpr int kGridSize = kGridVertices * kGridVertices;
inline constexpr int kBlockCells = 4;
inline constexpr int kBlocksAlong = kGridCells / kBlockCells;  ///< along one side
inline constexpr int kBlocks = kBlocksAlong * kBlocksAlong;
inline constexpr uint32_t kGridTriangles = 2 * kGridCells * kGridCells;

/// Padding of a block's box around its vertices, local units: the error of a float ray's points (the derivation is at
/// kBoxPadding in trace/local_ray.h).
inline constexpr float kBlockPadding = 0x1p-19f;

inline constexpr int kBlockVertices = kBlockCells + 1;  ///< along one side
inline constexpr int kBlockSize = kBlockVertices * kBlockVertices;

/// How a grid's vertices are stored. Float suits surfaces as wide as they are long. Fixed is for thin ones: integer
/// numbers of steps of 2^-30, exact in double, so that a strand of a millionth of its length is still round.
enum class VertexFormat : uint8_t { Float, Fixed };
inline constexpr double kFixedStep = 0x1p-30;

/// The destination of dicing, row by row: by axis, vertex (i, j) at j * (quads + 1) + i.
struct VertexRows {
    int quads = 0;  ///< along a side
    float* axes[3] = {};
};

/// Diced vertices row by row: vertex (i, j) is at j * 17 + i.
struct GridRows {
    float vertices[3][kGridSize];  ///< by axis

    VertexRows target() { return {kGridCells, {vertices[0], vertices[1], vertices[2]}}; }
};

struct alignas(64) Grid {
    /// Padded boxes of the blocks: by axis, low then high. Block 4 * (j / 4) + i / 4 holds cell (i, j).
    float boxes[3][2][kBlocks];
    /// By block and axis: vertex (i, j) of the block is at j * 5 + i. The dicer knows which of the two it is.
    union {
        float vertices[kBlocks][3][kBlockSize];
        int32_t fixed[kBlocks][3][kBlockSize];
    };

    /// Vertex of a grid of floats, 0 <= i, j <= 16.
    Vec3f vertex(int i, int j) const;
    FacetCorners corners(uint32_t triangle, VertexFormat format) const;
    /// Box of all vertices, padded as the blocks' are.
    Box3f box() const;
};

/// The three vertices of a triangle, as indices into its block.
struct BlockTriangle {
    int block, vertices[3];
};
inline BlockTriangle block_triangle(uint32_t triangle) {
    const int i = static_cast<int>(triangle / 2) % kGridCells, j = static_cast<int>(triangle / 2) / kGridCells;
    const int block = j / kBlockCells * kBlocksAlong + i / kBlockCells;
    const int low = j % kBlockCells * kBlockVertices + i % kBlockCells, high = low + kBlockVertices + 1;
    return triangle % 2 == 0 ? BlockTriangle{block, {low, high, low + 1}} : BlockTriangle{block, {low, high - 1, high}};
}

inline FacetCorners Grid::corners(uint32_t triangle, VertexFormat format) const {
    const BlockTriangle of = block_triangle(triangle);
    if (format == VertexFormat::Fixed) {
        const int32_t(&f)[3][kBlockSize] = fixed[of.block];
        const auto at = [&](int k) { return Vec3d(f[0][k], f[1][k], f[2][k]) * kFixedStep; };
        return {at(of.vertices[0]), at(of.vertices[1]), at(of.vertices[2])};
    }
    const float(&f)[3][kBlockSize] = vertices[of.block];
    const auto at = [&](int k) { return Vec3d(f[0][k], f[1][k], f[2][k]); };
    return {at(of.vertices[0]), at(of.vertices[1]), at(of.vertices[2])};
}

/// The same surface in 4 x 4 cells: every fourth vertex of the fine grid, (i, j) at j * 5 + i.
struct alignas(64) MediumGrid {
    float vertices[3][kBlockSize];

    VertexRows target() { return {kBlockCells, {vertices[0], vertices[1], vertices[2]}}; }
};

/// The same in one cell: the corners of the fine grid, (i, j) at j * 2 + i.
inline constexpr int kCorners = 4;

/// The largest place within a cell, in cells, where the far border belongs to another cell.
inline constexpr double kBelowOne = 1.0 - 0x1p-40;

/// Where in a grid a point of a triangle lies: i + fraction, j + fraction.
Vec2d grid_parameters(uint32_t triangle, double weight1, double weight2);

/// The same, but never on the far borders of the triangle's cell: in a folded grid (swept_dicer.h) the cell beyond is
/// elsewhere on the surface.
Vec2d parameters_in_cell(uint32_t triangle, double weight1, double weight2);

/// The triangle of a grid at grid parameters in [0,16]², and the weights of its corners 1 and 2.
struct GridPlace {
    uint32_t triangle = 0;
    double weight1 = 0, weight2 = 0;
};
GridPlace grid_place(const Vec2d& parameters);

}  // namespace rayleaf
