// The interface by which grids of a surface are traced: its subpatches for one view, and the vertices of each.
//
// A subpatch's grid must be a pure function of the subpatch, and vertices on a border that two subpatches share must
// have the same bits in both; then no ray passes between them (grid_intersection.h). Each kind of curved surface has
// one implementation. If it has levels, a vertex has the same bits at all of them, and in parts.
#pragma once

#include "rays/hit.h"
#include "tessellation/grid.h"
#include "tessellation/snapped_grid.h"
#include "tessellation/step_grid.h"

#include <cstdint>
#include <functional>
#include <optional>

namespace rayleaf {

/// The smallest distance of facets from a surface that single precision allows. Local units.
inline constexpr double kFinestTolerance = 0x1p-22;

/// How far a surface's facets may lie from it, for a part of it within the given box. Local units.
using FacetTolerance = std::function<double(const Box3d& box)>;

/// A place in the grid of a subpatch: i + fraction, j + fraction.
struct PlaceInGrid {
    uint32_t subpatch = 0;
    Vec2d at{0, 0};
};

/// A place on a shape's element.
struct ElementPlace {
    uint32_t element = 0;
    float u = 0, v = 0;
};

/// Bounds of a subpatch, local space: a box enlarged by kBlockPadding, and a ball swept along a chain of lines, which
/// is much tighter around thin parts that do not run along an axis. A negative radius: there is none.
struct SubpatchBounds {
    static constexpr int kLines = 4;
    struct alignas(64) Tube {
        float points[3][kLines + 1] = {};  ///< by axis
        float radius = -1;
    };
    Box3f box;
    Tube tube;
};

class Dicer {
  public:
    explicit Dicer(VertexFormat format) : format_(format) {}
    virtual ~Dicer() = default;
    Dicer(const Dicer&) = delete;
    Dicer& operator=(const Dicer&) = delete;

    VertexFormat format() const { return format_; }
    virtual uint32_t subpatch_count() const = 0;
    virtual void dice(uint32_t subpatch, Grid& grid) const = 0;
    /// Vertices in fixed-point numbers are multiples of 2^this, so that grids can be stored in steps (StepGrid); 0:
    /// they cannot.
    virtual int step_shift() const { return 0; }
    void dice_steps(uint32_t subpatch, StepGrid& grid) const {
        Grid diced;
        dice(subpatch, diced);
        pack(diced, step_shift(), grid);
    }
    /// By default the grid's own box.
    virtual SubpatchBounds bounds(uint32_t subpatch) const {
        Grid grid;
        dice(subpatch, grid);
        return {grid.box(), {}};
    }
    /// The shape's element and its parameters at a place in a grid; `position` is the point on the facet, local space.
    virtual ElementPlace element_place(const PlaceInGrid& place, const Vec3d& position) const = 0;
    /// The inverse of element_place; empty if the facets are the surface itself.
    virtual std::optional<PlaceInGrid> place_in_grid(const ElementPlace& place) const = 0;
    /// Bytes held, itself included.
    virtual size_t bytes() const = 0;

    /// Null if all rays see fine grids.
    virtual const class LevelDicer* levels() const { return nullptr; }

  private:
    VertexFormat format_;
};

/// Dices at several levels (tessellation/level.h), in floats. A surface computes the vertices of one level or of a
/// part; this class makes grids of them.
class LevelDicer : public Dicer {
  public:
    LevelDicer() : Dicer(VertexFormat::Float) {}
    const LevelDicer* levels() const final { return this; }

    void dice(uint32_t subpatch, Grid& grid) const final;
    void dice_rows(uint32_t subpatch, GridRows& rows) const { dice_level(subpatch, kFine, rows.target()); }
    void dice_medium(uint32_t subpatch, MediumGrid& grid) const { dice_level(subpatch, kMedium, grid.target()); }
    void dice_part(uint32_t subpatch, const GridPart& part, Grid& grid) const;
    /// Rays that ask for a finer level see this one.
    virtual int finest_level() const { return kFinestLevel; }
    /// Whether dicing takes far longer than keeping what was diced.
    virtual bool is_slow() const { return false; }

  private:
    /// Dices the fine or the medium level.
    virtual void dice_level(uint32_t subpatch, int level, const VertexRows& target) const = 0;
    virtual void dice_part_rows(uint32_t subpatch, const GridPart& part, const VertexRows& target) const = 0;
};

}  // namespace rayleaf
