#include "tessellation/facet_blocks.h"

#include "tessellation/ray_packet.h"

#include <algorithm>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// The smallest k with 4^k >= `segments_squared`, at most the finest.
uint8_t log2_for(double segments_squared) {
    int k = 0;
    while (k < Resolution::kFinest && segments_squared > static_cast<double>(uint64_t{1} << (2 * k))) ++k;
    return static_cast<uint8_t>(k);
}

Box3d box_of_corners(std::span<const DicedForm> forms, uint32_t subpatch, std::span<const int> corners) {
    Box3d box;
    for (const DicedForm& form : forms) {
        const auto& at = form.details[subpatch].corners;
        for (const int k : corners) box.extendBy(Vec3d(at[0][k], at[1][k], at[2][k]));
    }
    return box;
}

/// The largest of all times. In between, second differences are no larger.
double largest_bend(std::span<const DicedForm> forms, const auto& bend_of) {
    double largest = 0.0;
    for (const DicedForm& form : forms) largest = std::max<double>(largest, DetailCode::length(bend_of(form)));
    return largest;
}

/// The three corners of each triangle of a block, as vertices (i, j) at j * 5 + i.
constexpr std::array<std::array<uint8_t, 3>, kBlockTriangles> corner_table() {
    std::array<std::array<uint8_t, 3>, kBlockTriangles> table{};
    for (uint32_t triangle = 0; triangle < kBlockTriangles; ++triangle) {
        const uint32_t i = triangle / 2 % kBlockCells, j = triangle / 2 / kBlockCells;
        const uint32_t low = j * kBlockVertices + i, high = low + kBlockVertices + 1;
        const uint32_t second = triangle % 2 == 0 ? high : high - 1, third = triangle % 2 == 0 ? low + 1 : high;
        table[triangle] = {static_cast<uint8_t>(low), static_cast<uint8_t>(second), static_cast<uint8_t>(third)};
    }
    return table;
}
constexpr std::array<std::array<uint8_t, 3>, kBlockTriangles> kCornersOf = corner_table();

/// The number in the grid of 16 x 16 cells of a triangle of a block.
uint32_t grid_triangle(const FacetBlock& block, uint32_t triangle) {
    const uint32_t i = block.column + triangle / 2 % kBlockCells, j = block.row + triangle / 2 / kBlockCells;
    return 2 * (j * kGridCells + i) + triangle % 2;
}

/// Sets every fourth vertex along both sides.
void dice_medium(const LevelDicer& dicer, uint32_t subpatch, GridRows& rows) {
    MediumGrid medium;
    dicer.dice_medium(subpatch, medium);
    for (int axis = 0; axis < 3; ++axis)
        for (int k = 0; k < kBlockSize; ++k)
            rows.vertices[axis][(k / kBlockVertices * kGridVertices + k % kBlockVertices) * kBlockCells] =
                medium.vertices[axis][k];
}

/// Sets the vertices of a resolution's cells, and maybe others.
void dice_needed(const LevelDicer& dicer, uint32_t subpatch, const Resolution& resolution, const SubpatchDetail& detail,
                 GridRows& rows) {
    if (resolution.needs_fine_grid()) return dicer.dice_rows(subpatch, rows);
    if (resolution.cells() > 1) return dice_medium(dicer, subpatch, rows);
    for (int axis = 0; axis < 3; ++axis)
        for (int k = 0; k < kCorners; ++k)
            rows.vertices[axis][(k / 2 * kGridVertices + k % 2) * kGridCells] = detail.corners[axis][k];
}

/// For each vertex of a block, whether the one so many places after it lies at the same point.
template <typename Number>
std::array<uint8_t, kBlockSize> equals_after(const Number (&vertices)[3][kBlockSize], int places) {
    std::array<uint8_t, kBlockSize> equal{};
    for (int k = 0; k + places < kBlockSize; ++k)
        equal[static_cast<size_t>(k)] = static_cast<uint8_t>((vertices[0][k] == vertices[0][k + places] ? 1 : 0) &
                                                             (vertices[1][k] == vertices[1][k + places] ? 1 : 0) &
                                                             (vertices[2][k] == vertices[2][k + places] ? 1 : 0));
    return equal;
}

/// A bit for each triangle whose corners differ.
template <typename Number>
uint32_t triangles_with_area(const Number (&vertices)[3][kBlockSize]) {
    const auto along = equals_after(vertices, 1), up = equals_after(vertices, kBlockVertices),
               across = equals_after(vertices, kBlockVertices + 1);
    uint32_t triangles = 0;
    for (uint32_t j = 0, cell = 0; j < kBlockCells; ++j) {
        for (uint32_t i = 0; i < kBlockCells; ++i, ++cell) {
            const uint32_t low = j * kBlockVertices + i, high = low + kBlockVertices;
            const uint32_t below = across[low] | along[low] | up[low + 1], above = across[low] | up[low] | along[high];
            triangles |= (below == 0 ? 1u : 0u) << 2 * cell | (above == 0 ? 2u : 0u) << 2 * cell;
        }
    }
    return triangles;
}

/// Where vertex `at` of a subpatch's cells lies along a border in its grid, once it is drawn to one of the border's.
/// Half a step goes up. At corners nothing moves: they are whole steps of every border.
int drawn_along(const Resolution& resolution, size_t border, int at) {
    const int step = Resolution::kFinest - resolution.border[border];
    return ((at << (Resolution::kFinest - resolution.own)) + (1 << step >> 1)) >> step << step;
}

/// The vertices of a subpatch's cells, with those of its borders drawn to the borders'.
class DrawnBorders {
  public:
    explicit DrawnBorders(const Resolution& resolution)
        : cells_(resolution.cells()), apart_(Resolution::kFinest - resolution.own) {
        for (size_t border = 0; border < kBorders; ++border)
            for (int at = 0; at <= cells_; ++at)
                at_[border][at] = static_cast<uint8_t>(drawn_along(resolution, border, at));
    }
    /// The place of vertex (i, j) in the grid's rows.
    int place(int i, int j) const {
        i = std::min(i, cells_);
        j = std::min(j, cells_);
        int x = i << apart_, y = j << apart_;
        if (j == 0) x = at_[0][i];
        if (j == cells_) x = at_[2][i];
        if (i == cells_) y = at_[1][j];
        if (i == 0) y = at_[3][j];
        return y * kGridVertices + x;
    }

  private:
    int cells_, apart_;
    uint8_t at_[kBorders][kGridVertices];
};

}  // namespace

Resolution resolution_for(std::span<const DicedForm> forms, uint32_t subpatch, const FacetTolerance& tolerance) {
    // n segments lie within bend / n² of the border (SubpatchDetail).
    Resolution resolution;
    constexpr int kAll[kCorners] = {0, 1, 2, 3};
    const double inner = largest_bend(forms, [&](const DicedForm& form) { return form.details[subpatch].inner_bend; });
    resolution.own = log2_for(inner / tolerance(box_of_corners(forms, subpatch, kAll)));
    for (size_t border = 0; border < kBorders; ++border) {
        const double allowed = tolerance(box_of_corners(forms, subpatch, kBorderEnds[border]));
        const double bend =
            largest_bend(forms, [&](const DicedForm& form) { return form.details[subpatch].bend[border]; });
        resolution.border[border] = log2_for(bend / allowed);
        resolution.own = std::max(resolution.own, resolution.border[border]);
    }
    return resolution;
}

GridVertex drawn_vertex(const Resolution& resolution, int i, int j) {
    const int cells = resolution.cells(), apart = Resolution::kFinest - resolution.own;
    i = std::min(i, cells);
    j = std::min(j, cells);
    GridVertex vertex{i << apart, j << apart};
    if (j == 0) vertex.i = drawn_along(resolution, 0, i);
    if (j == cells) vertex.i = drawn_along(resolution, 2, i);
    if (i == cells) vertex.j = drawn_along(resolution, 1, j);
    if (i == 0) vertex.j = drawn_along(resolution, 3, j);
    return vertex;
}

FacetCorners FacetBlock::corners(uint32_t triangle, VertexFormat format) const {
    const auto& [a, b, c] = kCornersOf[triangle];
    return {vertex(a, format), vertex(b, format), vertex(c, format)};
}

void FacetBlock::note_facets(VertexFormat format) {
    facets = format == VertexFormat::Fixed ? triangles_with_area(fixed) : triangles_with_area(vertices);
}

FacetBlocks::FacetBlocks(std::span<const DicedForm> forms, const FacetTolerance& tolerance)
    : format_(forms[0].dicer->format()),
      resolutions_(forms[0].dicer->subpatch_count()),
      first_(resolutions_.size() + 1),
      steps_(forms.size()) {
    if (!forms[0].details.empty())
        tbb::parallel_for(size_t{0}, forms[0].details.size(), [&](size_t i) {
            resolutions_[i] = resolution_for(forms, static_cast<uint32_t>(i), tolerance);
        });
    for (size_t i = 0; i < resolutions_.size(); ++i) {
        const auto along = static_cast<uint64_t>(resolutions_[i].blocks());
        first_[i + 1] = first_[i] + along * along;
    }
}

void FacetBlocks::fill(std::span<const DicedForm> forms, const CancelToken& cancel) {
    blocks_ = LargeArray<FacetBlock>(block_count() * steps_);
    tbb::parallel_for(uint32_t{0}, static_cast<uint32_t>(resolutions_.size()), [&](uint32_t subpatch) {
        cancel.throw_if_cancelled();
        for (size_t step = 0; step < steps_; ++step) {
            const DicedForm& form = forms[step];
            if (form.dicer->levels())
                fill_levels(form, subpatch, step);
            else
                fill_fixed(*form.dicer, subpatch);
        }
    });
}

/// Vertices that blocks share have the same bits at both times, and so between them.
void FacetBlocks::mix(uint32_t index, float time, FacetBlock& room) const {
    const StepShare step = step_share(time, steps_);
    const FacetBlock &from = blocks_[index * steps_ + step.first], &to = blocks_[index * steps_ + step.first + 1];
    const auto share = static_cast<float>(step.share);
    const float *a = from.vertices[0], *b = to.vertices[0];
    float* between = room.vertices[0];
    for (int k = 0; k < 3 * kBlockSize; ++k) between[k] = a[k] + (b[k] - a[k]) * share;
    room.subpatch = from.subpatch;
    room.facets = from.facets | to.facets;
    room.column = from.column;
    room.row = from.row;
}

void FacetBlocks::fill_levels(const DicedForm& form, uint32_t subpatch, size_t step) {
    const Resolution& resolution = resolutions_[subpatch];
    const GridRows* known = form.grids.empty() ? nullptr : form.grids[subpatch].get();
    GridRows diced;
    if (!known) dice_needed(*form.dicer->levels(), subpatch, resolution, form.details[subpatch], diced);
    const GridRows& rows = known ? *known : diced;
    const DrawnBorders drawn(resolution);
    int number = 0;
    for (int row = 0; row < resolution.blocks(); ++row) {
        for (int column = 0; column < resolution.blocks(); ++column) {
            FacetBlock* const block = &block_of(subpatch, number++, step);
            block->subpatch = subpatch;
            block->column = static_cast<uint8_t>(column * kBlockCells);
            block->row = static_cast<uint8_t>(row * kBlockCells);
            for (int k = 0; k < kBlockSize; ++k) {
                const int from = drawn.place(block->column + k % kBlockVertices, block->row + k / kBlockVertices);
                for (int axis = 0; axis < 3; ++axis) block->vertices[axis][k] = rows.vertices[axis][from];
            }
            block->note_facets(format_);
        }
    }
}

void FacetBlocks::fill_fixed(const Dicer& dicer, uint32_t subpatch) {
    Grid grid;
    dicer.dice(subpatch, grid);
    for (int k = 0; k < kBlocks; ++k) {
        FacetBlock& block = block_of(subpatch, k, 0);
        block.subpatch = subpatch;
        block.column = static_cast<uint8_t>(k % kBlocksAlong * kBlockCells);
        block.row = static_cast<uint8_t>(k / kBlocksAlong * kBlockCells);
        std::copy(&grid.fixed[k][0][0], &grid.fixed[k][0][0] + 3 * kBlockSize, &block.fixed[0][0]);
        block.note_facets(format_);
    }
}

Box3f FacetBlocks::box(uint32_t index) const {
    Box3f box;
    for (size_t step = 0; step < steps_; ++step) box.extendBy(box_at(index, step));
    return box;
}

Box3f FacetBlocks::box_at(uint32_t index, size_t step) const {
    const FacetBlock& block = blocks_[index * steps_ + step];
    Box3d box;
    for (int k = 0; k < kBlockSize; ++k) box.extendBy(block.vertex(k, format_));
    const Vec3f padding(kBlockPadding);
    return {Vec3f(box.min) - padding, Vec3f(box.max) + padding};
}

std::vector<Vec3d> FacetBlocks::vertices() const {
    std::vector<Vec3d> all;
    all.reserve(blocks_.size() * kBlockSize);
    for (size_t block = 0; block < blocks_.size(); ++block)
        for (int k = 0; k < kBlockSize; ++k) all.push_back(blocks_[block].vertex(k, format_));
    return all;
}

Vec2d FacetBlocks::place(uint32_t index, uint32_t triangle, double weight1, double weight2) const {
    const FacetBlock& block = (*this)[index];
    if (format_ == VertexFormat::Fixed) return parameters_in_cell(grid_triangle(block, triangle), weight1, weight2);
    const Resolution& resolution = resolutions_[block.subpatch];
    const auto at = [&](int corner) {
        const GridVertex drawn =
            drawn_vertex(resolution, block.column + corner % kBlockVertices, block.row + corner / kBlockVertices);
        return Vec2d(drawn.i, drawn.j);
    };
    const auto& [a, b, c] = kCornersOf[triangle];
    const Vec2d first = at(a);
    return first + (at(b) - first) * weight1 + (at(c) - first) * weight2;
}

FacetBlocks::Facet FacetBlocks::facet_at(const PlaceInGrid& place) const {
    const Resolution& resolution = resolutions_[place.subpatch];
    const int cells = resolution.cells();
    const Vec2d at = place.at * (static_cast<double>(cells) / kGridCells);
    const int i = std::clamp(static_cast<int>(at.x), 0, cells - 1),
              j = std::clamp(static_cast<int>(at.y), 0, cells - 1);
    const double x = std::clamp(at.x - i, 0.0, 1.0), y = std::clamp(at.y - j, 0.0, 1.0);
    const int block = j / kBlockCells * resolution.blocks() + i / kBlockCells;
    const auto triangle = static_cast<uint32_t>(2 * (j % kBlockCells * kBlockCells + i % kBlockCells));
    const auto number = static_cast<uint32_t>(first_[place.subpatch] + static_cast<uint64_t>(block));
    // Corners (0,0), (1,1), (1,0) below the diagonal, (0,0), (0,1), (1,1) above.
    if (x >= y) return {number, triangle, y, x - y};
    return {number, triangle + 1, y - x, x};
}

}  // namespace rayleaf
