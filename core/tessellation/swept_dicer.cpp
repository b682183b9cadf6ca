#include "tessellation/swept_dicer.h"

#include "base/error.h"
#include "tessellation/swept_tube.h"

#include <algorithm>

namespace rayleaf {
namespace {

/// The nearest number of steps of 2^shift.
int32_t fixed_number(double local, int shift) {
    return static_cast<int32_t>(std::lrint(local / step_length(shift))) * (1 << shift);
}

/// Packs the vertices of a block, (i, j) at first[j * stride + i], into a grid of fixed numbers.
void pack_block(const Vec3d* first, int stride, int block, int shift, Grid& grid) {
    Box3d box;
    const float padding = kBlockPadding + static_cast<float>(step_length(shift));
    for (int j = 0; j < kBlockVertices; ++j) {
        for (int i = 0; i < kBlockVertices; ++i) {
            const Vec3d& vertex = first[j * stride + i];
            box.extendBy(vertex);
            for (int axis = 0; axis < 3; ++axis)
                grid.fixed[block][axis][j * kBlockVertices + i] = fixed_number(vertex[axis], shift);
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        grid.boxes[axis][0][block] = static_cast<float>(box.min[axis]) - padding;
        grid.boxes[axis][1][block] = static_cast<float>(box.max[axis]) + padding;
    }
}

/// Packs all blocks of a grid whose vertices are [j][i].
void pack_all(const Vec3d (&vertices)[kGridVertices][kGridVertices], int shift, Grid& grid) {
    for (int block = 0; block < kBlocks; ++block)
        pack_block(&vertices[block / kBlocksAlong * kBlockCells][block % kBlocksAlong * kBlockCells], kGridVertices,
                   block, shift, grid);
}

}  // namespace

SweptDicer::SweptDicer(const SweptSurface& surface, const FacetTolerance& tolerance)
    : Dicer(VertexFormat::Fixed), surface_(&surface) {
    for (const SweepProfile& profile : surface.profiles()) profiles_.push_back(profile_cells(profile));
    plan(tolerance);
    const size_t splines = surface.path().splines.size();
    for (size_t profile = 0; profile < profiles_.size(); ++profile) {
        std::vector<bool> used(profiles_[profile].size());
        for (size_t s = 0; s < splines; ++s) used[tubes_[profile * splines + s].level] = true;
        for (size_t level = 0; level < used.size(); ++level) {
            ProfileCells& cells = profiles_[profile][level];
            if (!used[level])
                cells = {};
            else if (surface.has_caps())
                add_cap(cells, surface.profiles()[profile]);
        }
    }
    number();
    for (const SweptFill& fill : surface.fills()) {
        first_fill_subpatch_.push_back(subpatch_count_);
        add_subpatches(fills_.emplace_back(fill_cells(fill)).grids());
    }
}

/// Border vertices are those of the walls' outermost rows. Outlines of curves run clockwise.
FillCells SweptDicer::fill_cells(const SweptFill& fill) const {
    std::vector<FixedVertex> vertices;
    std::vector<uint32_t> begins{0};
    for (const uint32_t spline : fill.splines) {
        for (uint32_t station = cells_along_[spline]; station > 0; --station) {
            const PiecePlace place = piece_at(spline, station);
            const SweepRing ring = surface_->path().ring(surface_->path().pieces[place.piece], place.u);
            const Vec3d vertex = ring.at(fill.border.place);
            vertices.push_back({fixed_number(vertex.x), fixed_number(vertex.y), fixed_number(vertex.z)});
        }
        begins.push_back(static_cast<uint32_t>(vertices.size()));
    }
    return {std::move(vertices), begins,
            fill.border.side == FillSide::Front ? FillFacing::Upwards : FillFacing::Downwards};
}

std::optional<uint32_t> SweptDicer::fill_of(uint32_t subpatch) const {
    if (first_fill_subpatch_.empty() || subpatch < first_fill_subpatch_.front()) return std::nullopt;
    const auto after = std::upper_bound(first_fill_subpatch_.begin(), first_fill_subpatch_.end(), subpatch);
    return static_cast<uint32_t>(after - first_fill_subpatch_.begin()) - 1;
}

uint64_t SweptDicer::walls(const TubePlace& place) const {
    return uint64_t{cells_along_[place.spline]} / kGridCells * static_cast<uint64_t>(cells(place).count / kGridCells);
}

void SweptDicer::add_subpatches(uint64_t count) {
    if (count > kMostSubpatches - subpatch_count_)
        throw InputError(surface_->name(), "subpatches", "more than " + std::to_string(kMostSubpatches),
                         "fewer splines, or profiles of fewer points");
    subpatch_count_ += static_cast<uint32_t>(count);
}

void SweptDicer::number() {
    const auto splines = static_cast<uint32_t>(surface_->path().splines.size());
    for (uint32_t tube = 0; tube < tubes_.size(); ++tube) {
        const TubePlace place{tube, tube / splines, tube % splines, 0};
        tubes_[tube].first_subpatch = subpatch_count_;
        add_subpatches(walls(place));
        if (surface_->has_caps() && surface_->path().splines[place.spline].capped)
            add_subpatches(uint64_t{2} * cells(place).cap_grids());
    }
}

SweptDicer::TubePlace SweptDicer::tube_place(uint32_t subpatch) const {
    const auto after = std::upper_bound(tubes_.begin(), tubes_.end(), subpatch,
                                        [](uint32_t s, const Tube& tube) { return s < tube.first_subpatch; });
    const auto tube = static_cast<uint32_t>(after - tubes_.begin()) - 1;
    const auto splines = static_cast<uint32_t>(surface_->path().splines.size());
    return {tube, tube / splines, tube % splines, subpatch - tubes_[tube].first_subpatch};
}

/// The piece that a ring belongs to: the later one where two meet.
SweptDicer::PiecePlace SweptDicer::piece_at(uint32_t spline_index, uint32_t station) const {
    const SweepSpline& spline = surface_->path().splines[spline_index];
    const uint32_t total = cells_along_[spline_index];
    if (station == total)
        return spline.closed ? PiecePlace{spline.first_piece, 0.0, 1}
                             : PiecePlace{spline.first_piece + spline.piece_count - 1, 1.0, 1};
    const auto begin = first_cell_.begin() + spline.first_piece, end = begin + spline.piece_count;
    // Mostly all pieces have about as many cells, and the first guess is right.
    const auto guess = begin + static_cast<std::ptrdiff_t>(uint64_t{station} * spline.piece_count / total);
    auto found = guess;
    if (!(*guess <= station && (guess + 1 == end || station < guess[1])))
        found =
            (*guess <= station ? std::upper_bound(guess + 1, end, station) : std::upper_bound(begin, guess, station)) -
            1;
    const uint32_t cells = (found + 1 == end ? total : *(found + 1)) - *found;
    return {static_cast<uint32_t>(found - first_cell_.begin()), static_cast<double>(station - *found) / cells, cells};
}

SweptDicer::WallPart SweptDicer::wall_part(const TubePlace& place) const {
    WallPart part;
    part.layout = layout(place);
    const uint32_t first = place.local / part.layout.grids_around * part.layout.cells_along();
    for (uint32_t i = 0; i <= part.layout.cells_along(); ++i) {
        const PiecePlace at = piece_at(place.spline, first + i);
        part.rings[i] = surface_->path().ring(surface_->path().pieces[at.piece], at.u);
    }
    part.corners = &cells(place).corners[place.local % part.layout.grids_around * part.layout.cells_around()];
    return part;
}

void SweptDicer::dice(uint32_t subpatch, Grid& grid) const {
    if (const std::optional<uint32_t> fill = fill_of(subpatch)) {
        Vec3d vertices[kGridVertices][kGridVertices];
        fills_[*fill].place(subpatch - first_fill_subpatch_[*fill], vertices);
        pack_all(vertices, shift_, grid);
        return;
    }
    const TubePlace place = tube_place(subpatch);
    if (place.local < walls(place))
        dice_wall(place, grid);
    else
        dice_cap(place, grid);
}

void SweptDicer::dice_wall(const TubePlace& place, Grid& grid) const {
    const WallPart part = wall_part(place);
    const std::span<const SweepRing> along = part.along();
    const std::span<const Vec2d> around = part.around();
    Vec3d vertices[kMostWallVertices];
    Vec3d* next = vertices;
    for (const Vec2d& corner : around)
        for (const SweepRing& ring : along) *next++ = ring.at(corner);
    const auto blocks_along = static_cast<int>(part.layout.blocks_along), stride = static_cast<int>(along.size());
    for (int block = 0; block < kBlocks; ++block)
        pack_block(vertices + (block / blocks_along * stride + block % blocks_along) * kBlockCells, stride, block,
                   shift_, grid);
}

/// Column 0 of the cap at an end is its outline, the others are the centre of the fan. The cap at the begin is the
/// mirror image, because it is seen from the other side.
void SweptDicer::dice_cap(const TubePlace& place, Grid& grid) const {
    const ProfileCells& around = cells(place);
    const uint32_t cap = place.local - static_cast<uint32_t>(walls(place)), grids = around.cap_grids();
    const CapEnd end = cap < grids ? CapEnd::Begin : CapEnd::End;
    const uint32_t number = cap % grids;
    const PiecePlace at = piece_at(place.spline, end == CapEnd::Begin ? 0 : cells_along_[place.spline]);
    const SweepRing ring = surface_->path().ring(surface_->path().pieces[at.piece], at.u);
    Vec2d outline[kGridVertices], inner[kGridVertices];
    if (around.center) {
        for (int j = 0; j < kGridVertices; ++j) {
            outline[j] = around.corners[number * kGridCells + j];
            inner[j] = *around.center;
        }
    } else {  // three columns for each triangle, with one cell that has an area
        for (int j = 0; j < kGridVertices; ++j) {
            const size_t wanted = number * kTrianglesInGrid + static_cast<size_t>(j / 3);
            const std::array<uint32_t, 3>& t = around.triangles[std::min(wanted, around.triangles.size() - 1)];
            const bool past = wanted >= around.triangles.size() || j / 3 >= static_cast<int>(kTrianglesInGrid);
            const int role = past ? 2 : j % 3;
            outline[j] = around.corners[role == 0 ? t[0] : (role == 1 ? t[1] : t[2])];
            inner[j] = around.corners[role == 0 ? t[0] : t[2]];
        }
    }
    Vec3d vertices[kGridVertices][kGridVertices];
    for (int j = 0; j < kGridVertices; ++j) {
        for (int i = 0; i < kGridVertices; ++i) {
            const bool rim = i == (end == CapEnd::End ? 0 : kGridCells);
            vertices[j][i] = ring.at(rim ? outline[j] : inner[j]);
        }
    }
    pack_all(vertices, shift_, grid);
}

SubpatchBounds SweptDicer::bounds(uint32_t subpatch) const {
    if (fill_of(subpatch)) return Dicer::bounds(subpatch);
    const TubePlace place = tube_place(subpatch);
    if (place.local >= walls(place)) return Dicer::bounds(subpatch);
    const WallPart part = wall_part(place);
    const std::span<const SweepRing> along = part.along();
    Imath::Box2d profile;
    double extent = 0.0, reach = 0.0;
    for (const Vec2d& corner : part.around()) {
        profile.extendBy(corner);
        extent = std::max(extent, corner.length());
    }
    const Vec2d middle = (profile.min + profile.max) * 0.5, half = (profile.max - profile.min) * 0.5;
    for (const Vec2d& corner : part.around()) reach = std::max(reach, (corner - middle).length());
    Box3d box;
    for (const SweepRing& ring : along) {
        const Vec3d center = ring.at(middle);
        Box3d square = box_of(ring, extent);
        for (int axis = 0; axis < 3; ++axis) {
            const double side = std::abs(ring.across[axis]) * half.x + std::abs(ring.up[axis]) * half.y;
            square.min[axis] = std::max(square.min[axis], center[axis] - side);
            square.max[axis] = std::min(square.max[axis], center[axis] + side);
        }
        box.extendBy(square);
    }
    const Vec3f padding(2.0f * kBlockPadding +
                        static_cast<float>(step_length(shift_)));  // margin for rounding of vertices
    return {{Vec3f(box.min) - padding, Vec3f(box.max) + padding}, tube_around(along, middle, reach)};
}

ElementPlace SweptDicer::element_place(const PlaceInGrid& in_grid, const Vec3d& position) const {
    if (const std::optional<uint32_t> fill = fill_of(in_grid.subpatch)) {
        const Vec2f parameters = surface_->fills()[*fill].parameters(position);
        return {surface_->fill_element(*fill), parameters.x, parameters.y};
    }
    const TubePlace place = tube_place(in_grid.subpatch);
    const ProfileCells& around = cells(place);
    const auto wall_count = static_cast<uint32_t>(walls(place));
    if (place.local >= wall_count) {
        const CapEnd end = place.local - wall_count < around.cap_grids() ? CapEnd::Begin : CapEnd::End;
        const SweepRing ring = surface_->end_ring(surface_->path().splines[place.spline], end);
        const Vec3d from = position - ring.center;
        const double across2 = ring.across.dot(ring.across), up2 = ring.up.dot(ring.up);
        const Vec2d at(across2 > 0.0 ? from.dot(ring.across) / across2 : 0.0,
                       up2 > 0.0 ? from.dot(ring.up) / up2 : 0.0);
        const Vec2f parameters = surface_->cap_parameters(place.profile, at);
        return {surface_->cap_element(place.profile, place.spline, end), parameters.x, parameters.y};
    }
    const WallLayout grids = layout(place);
    const Vec2d in_part = grids.unfolded(in_grid.at);
    const auto grids_before = static_cast<double>(place.local / grids.grids_around);
    const double along = grids_before * grids.cells_along() + in_part.x;
    const uint32_t station = std::min(static_cast<uint32_t>(along), cells_along_[place.spline] - 1);
    const PiecePlace begin = piece_at(place.spline, station);
    const double u = std::min(begin.u + std::clamp(along - station, 0.0, 1.0) / begin.cells, 1.0);
    const double v = place.local % grids.grids_around * grids.cells_around() + in_part.y;
    return {surface_->wall_element(place.profile, begin.piece), static_cast<float>(u),
            profile_parameter(surface_->profiles()[place.profile], around.place(v))};
}

std::optional<PlaceInGrid> SweptDicer::place_in_grid(const ElementPlace& at) const {
    const SweptElement element = surface_->element(at.element);
    if (element.part != SweptPart::Wall) return std::nullopt;
    const SweepPath& path = surface_->path();
    const SweepSpline& spline = path.spline_of(element.piece);
    const auto spline_index = static_cast<uint32_t>(&spline - path.splines.data());
    const auto tube = static_cast<uint32_t>(element.profile * path.splines.size() + spline_index);
    const TubePlace place{tube, element.profile, spline_index, 0};
    const ProfileCells& around = cells(place);
    const uint32_t last = spline.first_piece + spline.piece_count - 1, first = first_cell_[element.piece];
    const uint32_t end = element.piece == last ? cells_along_[spline_index] : first_cell_[element.piece + 1];
    const double along = first + (end - first) * static_cast<double>(at.u);
    const double v = around.at(profile_place(surface_->profiles()[element.profile], at.v));
    const WallLayout grids = layout(place);
    const auto column = std::min(static_cast<uint32_t>(along), cells_along_[spline_index] - 1) / grids.cells_along();
    const auto row = std::min(static_cast<uint32_t>(v), static_cast<uint32_t>(around.count) - 1) / grids.cells_around();
    return PlaceInGrid{tubes_[tube].first_subpatch + column * grids.grids_around + row,
                       grids.folded({along - column * grids.cells_along(), v - row * grids.cells_around()})};
}

size_t SweptDicer::bytes() const {
    size_t total = sizeof(*this) + first_cell_.capacity() * sizeof(uint32_t) +
                   first_fill_subpatch_.capacity() * sizeof(uint32_t) + cells_along_.capacity() * sizeof(uint32_t) +
                   tubes_.capacity() * sizeof(Tube);
    for (const std::vector<ProfileCells>& levels : profiles_)
        for (const ProfileCells& cells : levels)
            total += sizeof(cells) + cells.corners.capacity() * sizeof(Vec2d) +
                     cells.begins.capacity() * sizeof(ProfilePlace) + cells.lengths.capacity() * sizeof(double);
    for (const FillCells& fill : fills_) total += fill.bytes();
    return total;
}

}  // namespace rayleaf
