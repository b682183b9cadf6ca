// How many cells a swept surface has along and around, and how its grids lie.
#include "tessellation/swept_dicer.h"
#include "tessellation/swept_tube.h"

#include <algorithm>
#include <limits>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// The most subpatches of a shape, unless it has more splines.
constexpr uint64_t kMostSweptSubpatches = 1u << 20;
/// The most cells of a piece.
constexpr double kMostCells = 1 << 16;
/// Chords are within this share of the radius of the spline, whatever the view asks for: a ray aimed at the middle of a
/// strand must hit it.
constexpr double kMostShareOfRadius = 0.25;
/// Rings of a piece at which its bend is sampled.
constexpr int kPathLooks = 5;

/// A grid is folded while it stays longer than this share of its tube's width. Rays along the tube would meet too many
/// flatter slices.
constexpr double kLeastLength = 0.3;

/// The longest steps of vertices: in local units, and as shares of the wanted distance and of a tube's width.
constexpr double kLongestStep = 0x1p-18, kStepInTolerance = 0.125, kStepInWidth = 0x1p-10;
/// A middle line is longer than the chords that measure it, by less than this. Boxes decide in the end.
constexpr double kLongerThanChords = 1.2;

}  // namespace

/// The fineness that a view asks of a piece, and its size.
struct SweptDicer::PieceNeed {
    uint32_t cells = 1;
    double profile_error = 0;  ///< the largest distance of chords from the profile, profile units
    double length = 0;         ///< approximate, of its middle line
    double width = 0;
    double wanted = 0;  ///< the distance that facets may have from the surface
};

SweptDicer::PieceNeed SweptDicer::need_of(const SweepPath& path, const SweepPiece& piece, double extent,
                                          const FacetTolerance& tolerance) {
    SweepRing rings[kPathLooks];
    Box3d box;
    double radius = 0.0;
    PieceNeed need;
    for (int k = 0; k < kPathLooks; ++k) {
        rings[k] = path.ring(piece, static_cast<double>(k) / (kPathLooks - 1));
        box.extendBy(box_of(rings[k], extent));
        radius = std::max({radius, rings[k].across.length(), rings[k].up.length()});
        if (k > 0) need.length += (rings[k].center - rings[k - 1].center).length();
    }
    const double wanted = tolerance(box);
    need.wanted = wanted;
    need.profile_error = radius > 0.0 ? wanted / radius : std::numeric_limits<double>::infinity();
    const double size = radius * extent;
    need.width = 2.0 * size;
    const double most = size > 0.0 ? std::min(wanted, kMostShareOfRadius * size) : wanted;
    // Two triangles differ from a bilinear cell by |P_uv| hu hv / 4; around, a cell is at most a sixteenth of a
    // circle.
    constexpr double kLongestCell = 0.4;
    const SweepRing &first = rings[0], &last = rings[kPathLooks - 1];
    const double turn = extent * ((last.across - first.across).length() + (last.up - first.up).length());
    const double around = std::min(kLongestCell, size > 0.0 ? std::sqrt(8.0 * wanted / size) : kLongestCell);
    const double twist_cells = turn * around / (4.0 * most);
    const auto cells = [&](double wanted_cells) {
        return static_cast<uint32_t>(std::clamp(std::ceil(wanted_cells), 1.0, kMostCells));
    };
    need.cells = cells(twist_cells);
    if (piece.kind == SweepPieceKind::Ruled) return need;
    double bend = 0.0;
    const auto second = [&](const Vec3d SweepRing::*part, int k) {
        return ((rings[k + 1].*part - rings[k].*part) - (rings[k].*part - rings[k - 1].*part)).length();
    };
    for (int k = 1; k + 1 < kPathLooks; ++k)
        bend = std::max(
            bend, second(&SweepRing::center, k) + extent * (second(&SweepRing::across, k) + second(&SweepRing::up, k)));
    bend *= (kPathLooks - 1) * (kPathLooks - 1);
    need.cells = cells(std::max(twist_cells, std::sqrt(bend / (8.0 * most))));
    return need;
}

void SweptDicer::plan(const FacetTolerance& tolerance) {
    const SweepPath& path = surface_->path();
    double extent = 0.0;
    for (const SweepProfile& profile : surface_->profiles()) extent = std::max(extent, profile.extent());
    std::vector<PieceNeed> needs(path.pieces.size());
    tbb::parallel_for(size_t{0}, needs.size(),
                      [&](size_t i) { needs[i] = need_of(path, path.pieces[i], extent, tolerance); });
    tubes_.resize(profiles_.size() * path.splines.size());
    uint64_t around = 0;  // grids around all tubes of a spline, on average
    for (size_t s = 0; s < path.splines.size(); ++s) {
        const SweepSpline& spline = path.splines[s];
        double error = std::numeric_limits<double>::infinity();
        for (uint32_t k = 0; k < spline.piece_count; ++k)
            error = std::min(error, needs[spline.first_piece + k].profile_error);
        for (size_t profile = 0; profile < profiles_.size(); ++profile) {
            const std::vector<ProfileCells>& levels = profiles_[profile];
            uint8_t& level = tubes_[profile * path.splines.size() + s].level;
            while (level + size_t{1} < levels.size() && levels[level].error > error) ++level;
            around += static_cast<uint64_t>(levels[level].count / kGridCells);
        }
    }
    const double each =
        path.splines.empty() ? 1.0 : static_cast<double>(around) / static_cast<double>(path.splines.size());
    first_cell_.resize(path.pieces.size());
    cells_along_.resize(path.splines.size());
    for (double share = 1.0;; share *= 0.8) {
        uint64_t grids = 0;
        for (size_t s = 0; s < path.splines.size(); ++s) {
            const SweepSpline& spline = path.splines[s];
            uint64_t cells = 0;  // may exceed 32 bits before the limit below applies
            for (uint32_t p = spline.first_piece; p < spline.first_piece + spline.piece_count; ++p) {
                first_cell_[p] = static_cast<uint32_t>(cells);
                cells += std::max(1u, static_cast<uint32_t>(std::ceil(needs[p].cells * share)));
            }
            const uint64_t rows = (cells + kGridCells - 1) / kGridCells;
            cells_along_[s] = static_cast<uint32_t>(rows * kGridCells);
            grids += rows;
        }
        constexpr double kLeastShare = 1e-5;
        if (static_cast<double>(grids) * each <= kMostSweptSubpatches || share < kLeastShare) break;
    }
    fold(needs);
    choose_steps(needs);
}

void SweptDicer::fold(const std::vector<PieceNeed>& needs) {
    const SweepPath& path = surface_->path();
    for (size_t s = 0; s < path.splines.size(); ++s) {
        const SweepSpline& spline = path.splines[s];
        double length = 0.0, width = 0.0;
        for (uint32_t k = 0; k < spline.piece_count; ++k) {
            length += needs[spline.first_piece + k].length;
            width = std::max(width, needs[spline.first_piece + k].width);
        }
        const double block = length / cells_along_[s] * kBlockCells;
        for (size_t profile = 0; profile < profiles_.size(); ++profile) {
            Tube& tube = tubes_[profile * path.splines.size() + s];
            const auto around = static_cast<uint32_t>(profiles_[profile][tube.level].count);
            for (uint8_t half = tube.blocks_along / 2; half > 0; half /= 2) {
                if (around % (kBlocks / half * kBlockCells) != 0 || half * block < kLeastLength * width) break;
                tube.blocks_along = half;
            }
        }
    }
}

/// Chooses the steps of grids: long enough for each grid's box, if that is short enough for the view and for the
/// thinnest tube to be round. Filled areas are too large for steps.
void SweptDicer::choose_steps(const std::vector<PieceNeed>& needs) {
    const SweepPath& path = surface_->path();
    if (!surface_->fills().empty()) return;
    double longest = 0.0, shortest = kLongestStep;
    for (size_t s = 0; s < path.splines.size(); ++s) {
        const SweepSpline& spline = path.splines[s];
        uint8_t blocks = 0;
        for (size_t profile = 0; profile < profiles_.size(); ++profile)
            blocks = std::max(blocks, tubes_[profile * path.splines.size() + s].blocks_along);
        for (uint32_t k = 0; k < spline.piece_count; ++k) {
            const uint32_t piece = spline.first_piece + k;
            const uint32_t end = k + 1 == spline.piece_count ? cells_along_[s] : first_cell_[piece + 1];
            const PieceNeed& need = needs[piece];
            const double cell = need.length / (end - first_cell_[piece]);
            longest = std::max(longest, kLongerThanChords * cell * blocks * kBlockCells + need.width);
            shortest = std::min({shortest, need.wanted * kStepInTolerance, need.width * kStepInWidth});
        }
    }
    int shift = kLeastShift;
    while (longest > step_length(shift) * kMostSteps && step_length(shift) <= shortest) ++shift;
    if (step_length(shift) <= shortest) shift_ = shift;
}

SweptDicer::WallLayout SweptDicer::layout(const TubePlace& place) const {
    WallLayout layout{tubes_[place.tube].blocks_along, 1};
    layout.grids_around = static_cast<uint32_t>(cells(place).count) / layout.cells_around();
    return layout;
}

namespace {

/// Cell and place in it; the far end of the last cell is kept below the next.
struct CellPlace {
    uint32_t cell;
    double within;
};
CellPlace cell_place(double at, uint32_t cells) {
    const uint32_t cell = std::min(static_cast<uint32_t>(std::max(at, 0.0)), cells - 1);
    return {cell, std::min(at - cell, kBelowOne)};
}

}  // namespace

Vec2d SweptDicer::WallLayout::unfolded(const Vec2d& at) const {
    const CellPlace i = cell_place(at.x, kGridCells), j = cell_place(at.y, kGridCells);
    const uint32_t block = j.cell / kBlockCells * kBlocksAlong + i.cell / kBlockCells;
    const uint32_t column = block % blocks_along * kBlockCells + i.cell % kBlockCells;
    const uint32_t row = block / blocks_along * kBlockCells + j.cell % kBlockCells;
    return {column + i.within, row + j.within};
}

Vec2d SweptDicer::WallLayout::folded(const Vec2d& at) const {
    const CellPlace i = cell_place(at.x, cells_along()), j = cell_place(at.y, cells_around());
    const uint32_t block = j.cell / kBlockCells * blocks_along + i.cell / kBlockCells;
    const uint32_t column = block % kBlocksAlong * kBlockCells + i.cell % kBlockCells;
    const uint32_t row = block / kBlocksAlong * kBlockCells + j.cell % kBlockCells;
    return {column + i.within, row + j.within};
}

}  // namespace rayleaf
