// Bevelled curves diced along and around: many cells along a spline where it bends, few around where it is thin.
//
// Every piece of a spline has as many cells along as the view asks for, at least one; a profile has as many cells
// around, the same for a whole spline, so that rings meet vertex to vertex. The cells of consecutive pieces are divided
// into grids of 16, so a grid may hold parts of several pieces. The ring between two pieces is that of the later piece,
// at its begin. Where 16 cells along are longer than the tube is wide, a grid is folded: its blocks lie 2 along and 8
// around, or 1 and 16, so that fewer grids overlap in the boxes along a ray. Vertices are sums of the ring and the
// profile's point, always in the same order, rounded to steps of 2^-30: the same bits in every grid. Caps are fans
// about a point from which their whole outline is visible, or else triangulated; their outline is the last ring, bit by
// bit. The same holds for the borders of filled areas (swept_fill_cells.h), whose subpatches come last.
#pragma once

#include "geometry/swept_surface.h"
#include "tessellation/dicer.h"
#include "tessellation/profile_cells.h"
#include "tessellation/swept_fill_cells.h"

#include <cstdint>
#include <span>
#include <vector>

namespace rayleaf {

class SweptDicer final : public Dicer {
  public:
    SweptDicer(const SweptSurface& surface, const FacetTolerance& tolerance);

    uint32_t subpatch_count() const override { return subpatch_count_; }
    void dice(uint32_t subpatch, Grid& grid) const override;
    SubpatchBounds bounds(uint32_t subpatch) const override;
    ElementPlace element_place(const PlaceInGrid& place, const Vec3d& position) const override;
    std::optional<PlaceInGrid> place_in_grid(const ElementPlace& place) const override;
    size_t bytes() const override;
    int step_shift() const override { return shift_; }

  private:
    /// The grids of all shapes together are numbered with 31 bits.
    static constexpr uint32_t kMostSubpatches = 0x7fffffff;
    /// One profile along one spline.
    struct Tube {
        uint32_t first_subpatch = 0;
        uint8_t level = 0;                    ///< of the profile's cells
        uint8_t blocks_along = kBlocksAlong;  ///< of a grid of the wall, 4, 2 or 1; the others lie around
    };
    struct PieceNeed;
    /// The vertices of a grid of 4 by 64 cells.
    static constexpr int kMostWallVertices = (kBlockCells + 1) * (kBlocks * kBlockCells + 1);
    struct TubePlace {
        uint32_t tube, profile, spline;
        uint32_t local;  ///< number of the subpatch within the tube
    };
    /// How the grids of a wall lie on it.
    struct WallLayout {
        uint32_t blocks_along;  ///< of a grid
        uint32_t grids_around;

        uint32_t cells_along() const { return blocks_along * kBlockCells; }
        uint32_t cells_around() const { return kBlocks / blocks_along * kBlockCells; }
        /// From a place in a grid to cells along and around from the grid's first one, and back.
        Vec2d unfolded(const Vec2d& at) const;
        Vec2d folded(const Vec2d& at) const;
    };
    struct PiecePlace {
        uint32_t piece;
        double u;
        uint32_t cells;  ///< of the piece
    };

    const SweptSurface* surface_;
    std::vector<std::vector<ProfileCells>> profiles_;  ///< by profile and level
    std::vector<uint32_t> first_cell_;                 ///< of each piece, within its spline
    std::vector<uint32_t> cells_along_;                ///< of each spline, a multiple of 16
    std::vector<Tube> tubes_;                          ///< profile by profile, within one spline by spline
    std::vector<FillCells> fills_;                     ///< by the surface's fills
    std::vector<uint32_t> first_fill_subpatch_;        ///< of each
    uint32_t subpatch_count_ = 0;
    int shift_ = 0;  ///< vertices are multiples of 2^this steps

    void plan(const FacetTolerance& tolerance);
    void number();
    /// Throws InputError for more than a shape may have.
    void add_subpatches(uint64_t count);
    FillCells fill_cells(const SweptFill& fill) const;
    /// The fill that a subpatch belongs to; empty for walls and caps.
    std::optional<uint32_t> fill_of(uint32_t subpatch) const;
    TubePlace tube_place(uint32_t subpatch) const;
    PiecePlace piece_at(uint32_t spline, uint32_t station) const;
    const ProfileCells& cells(const TubePlace& place) const {
        return profiles_[place.profile][tubes_[place.tube].level];
    }
    uint64_t walls(const TubePlace& place) const;
    static PieceNeed need_of(const SweepPath& path, const SweepPiece& piece, double extent,
                             const FacetTolerance& tolerance);
    void fold(const std::vector<PieceNeed>& needs);
    void choose_steps(const std::vector<PieceNeed>& needs);
    WallLayout layout(const TubePlace& place) const;
    /// The rings of a wall's grid, and the profile's corners in it.
    struct WallPart {
        WallLayout layout;
        SweepRing rings[kGridVertices];  ///< layout.cells_along() + 1
        const Vec2d* corners;            ///< layout.cells_around() + 1

        std::span<const SweepRing> along() const { return {rings, layout.cells_along() + 1}; }
        std::span<const Vec2d> around() const { return {corners, layout.cells_around() + 1}; }
    };
    WallPart wall_part(const TubePlace& place) const;
    void dice_wall(const TubePlace& place, Grid& grid) const;
    void dice_cap(const TubePlace& place, Grid& grid) const;
};

}  // namespace rayleaf
