#include "tessellation/snapped_grid.h"

#include <cstring>

namespace rayleaf {
namespace {

/// Whether v is constant on a border; u is on the others.
constexpr bool runs_along_u(int border) {
    return border % 2 == 0;
}
/// Whether a border is the one at the high end of the other direction.
constexpr bool is_high(int border) {
    return border == 1 || border == 2;
}

/// A vertex of a block on one of its borders.
constexpr int block_index(int border, int k) {
    const int across = is_high(border) ? kBlockCells : 0;
    return runs_along_u(border) ? across * kBlockVertices + k : k * kBlockVertices + across;
}

}  // namespace

SnappedGrid::SnappedGrid(const Grid& grid, const SubpatchLevels& levels)
    : vertices_(&grid.vertices[0][0][0]), fine_(&grid), cells_(kGridCells) {
    for (int border = 0; border < kBorders; ++border) {
        if (levels.border[border] >= kFine) continue;
        snapped_ |= 1u << border;
        if (levels.border[border] == kMedium) continue;
        const int across = is_high(border) ? kGridCells : 0;
        const Vec3f low = runs_along_u(border) ? grid.vertex(0, across) : grid.vertex(across, 0);
        const Vec3f high = runs_along_u(border) ? grid.vertex(kGridCells, across) : grid.vertex(across, kGridCells);
        snap_to_ends(border, {low, high, 0, kGridCells, kGridCells / 2});
    }
}

SnappedGrid::SnappedGrid(const MediumGrid& grid, const SubpatchLevels& levels)
    : vertices_(&grid.vertices[0][0]), cells_(kBlockCells) {
    for (int border = 0; border < kBorders; ++border) {
        if (levels.border[border] >= kMedium) continue;
        snapped_ |= 1u << border;
        const int across = is_high(border) ? kBlockCells : 0;
        const Vec3f low = runs_along_u(border) ? grid_vertex(0, across) : grid_vertex(across, 0);
        const Vec3f high = runs_along_u(border) ? grid_vertex(kBlockCells, across) : grid_vertex(across, kBlockCells);
        snap_to_ends(border, {low, high, 0, kBlockCells, kBlockCells / 2});
    }
}

SnappedGrid::SnappedGrid(const Grid& part, const GridPart& place, const Grid& whole, const SubpatchLevels& levels)
    : vertices_(&part.vertices[0][0][0]), fine_(&part), cells_(kGridCells) {
    const int along = place.parts_along();
    const bool outer[kBorders] = {place.v == 0, place.u == along - 1, place.v == along - 1, place.u == 0};
    for (int border = 0; border < kBorders; ++border) {
        if (!outer[border] || levels.border[border] >= place.level) continue;
        snapped_ |= 1u << border;
        const int step = quads_along(place.level - levels.border[border]);  // in cells of this part
        if (step < kGridCells) continue;
        const int begin = (runs_along_u(border) ? place.u : place.v) * kGridCells;
        const int low_place = begin / step * step - begin, high_place = low_place + step;
        const int first_high = std::clamp(low_place + step / 2, 0, kGridVertices);
        const int across = is_high(border) ? kGridCells : 0;
        // A step of 16 ends at the part's own corners, a longer step at vertices of the fine grid.
        const auto end = [&](int at) {
            const int index = step == kGridCells ? at : (begin + at) / along;
            const Grid& grid = step == kGridCells ? part : whole;
            return runs_along_u(border) ? grid.vertex(index, across) : grid.vertex(across, index);
        };
        snap_to_ends(border, {end(low_place), end(high_place), low_place, high_place, first_high});
    }
}

void SnappedGrid::snap_to_ends(int border, const Ends& ends) {
    to_ends_ |= 1u << border;
    ends_[border] = ends;
}

uint32_t SnappedGrid::borders_of_block(int block) const {
    if (cells_ < kGridCells) return (1u << kBorders) - 1u;
    const int i = block % kBlocksAlong, j = block / kBlocksAlong;
    return (j == 0 ? 1u : 0u) | (i == kBlocksAlong - 1 ? 2u : 0u) | (j == kBlocksAlong - 1 ? 4u : 0u) |
           (i == 0 ? 8u : 0u);
}

void SnappedGrid::move_block(int block, float* out) const {
    const float* from = block_vertices(block);
    std::memcpy(out, from, 3 * kBlockSize * sizeof(float));
    const uint32_t moved = snapped_ & borders_of_block(block);
    for (int border = 0; border < kBorders; ++border) {
        if ((moved >> border & 1u) == 0) continue;
        const bool to_ends = (to_ends_ >> border & 1u) != 0;
        const int number = cells_ < kGridCells ? 0 : runs_along_u(border) ? block % kBlocksAlong : block / kBlocksAlong;
        const int first_high = to_ends ? ends_[border].first_high - number * kBlockCells : kBlockCells / 2;
        for (int axis = 0; axis < 3; ++axis) {
            const float* corners = from + axis * kBlockSize;
            const float low = to_ends ? ends_[border].low[axis] : corners[block_index(border, 0)];
            const float high = to_ends ? ends_[border].high[axis] : corners[block_index(border, kBlockCells)];
            for (int k = 0; k < kBlockVertices; ++k)
                out[axis * kBlockSize + block_index(border, k)] = k < first_high ? low : high;
        }
    }
}

uint32_t SnappedGrid::blocks_beyond_boxes() const {
    constexpr uint32_t kOfBorder[kBorders] = {0x000fu, 0x8888u, 0xf000u, 0x1111u};
    uint32_t blocks = 0;
    for (int border = 0; border < kBorders; ++border)
        if (to_ends_ >> border & 1u) blocks |= kOfBorder[border];
    return blocks;
}

Vec3f SnappedGrid::grid_vertex(int i, int j) const {
    if (fine_) return fine_->vertex(i, j);
    const int along = cells_ + 1, size = along * along, index = j * along + i;
    return {vertices_[index], vertices_[size + index], vertices_[2 * size + index]};
}

SnappedGrid::Vertex SnappedGrid::vertex(int i, int j) const {
    const bool on[kBorders] = {j == 0, i == cells_, j == cells_, i == 0};
    for (int border = 0; border < kBorders; ++border) {
        if (!on[border] || (snapped_ >> border & 1u) == 0) continue;
        const int k = runs_along_u(border) ? i : j;
        int place = (k + kBlockCells / 2) / kBlockCells * kBlockCells;
        if (to_ends_ >> border & 1u) {
            const Ends& ends = ends_[border];
            place = k < ends.first_high ? ends.low_place : ends.high_place;
            const Vec3f& position = k < ends.first_high ? ends.low : ends.high;
            return {position, runs_along_u(border) ? Vec2d(place, j) : Vec2d(i, place)};
        }
        (runs_along_u(border) ? i : j) = place;
        break;
    }
    return {grid_vertex(i, j), Vec2d(i, j)};
}

SnappedGrid::Facet SnappedGrid::facet(uint32_t triangle) const {
    const int i = static_cast<int>(triangle / 2) % cells_, j = static_cast<int>(triangle / 2) / cells_;
    const bool lower = triangle % 2 == 0;
    const Vertex corners[3] = {vertex(i, j), lower ? vertex(i + 1, j + 1) : vertex(i, j + 1),
                               lower ? vertex(i + 1, j) : vertex(i + 1, j + 1)};
    Facet result;
    for (int k = 0; k < 3; ++k) {
        result.corners[k] = Vec3d(corners[k].position);
        result.places[k] = corners[k].place;
    }
    return result;
}

}  // namespace rayleaf
