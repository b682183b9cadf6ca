// Bounds of media whose programs read grids (geometry/volume_grids.h), cell by cell.
//
// What the grids hold in a cell is known: at least and at most. The program runs with values of that range in their
// place: steps through it, all ends together, and others between, each at another place of the cell. So a bound is
// sound where the medium grows, or falls, with what each grid holds, however fine the grids are. The mean is that of
// some places.
#pragma once

#include "base/cancel.h"
#include "geometry/volume_grids.h"
#include "scene/majorant_grid.h"
#include "shading/inputs.h"

#include <functional>
#include <span>
#include <vector>

namespace rayleaf {

/// A point of object space, and what the grids are taken to hold there.
struct GridProbe {
    Vec3d point{0, 0, 0};
    std::vector<InstanceAttribute> assumed;
};

/// At probes; up to kMostPoints at once (shading/program.h).
using ProbeLookup = std::function<void(std::span<const GridProbe> probes, FoundDensity* found)>;

/// For a lattice of `cells`³ over `box`, x fastest. `read`: the grids that the program reads. 0 where nothing is held.
/// Throws Cancelled soon after `cancel` says so.
BoundedCells grid_majorants(const VolumeGrids& grids, std::span<const AttributeId> read, const Box3d& box, int cells,
                            const ProbeLookup& lookup, const CancelToken& cancel);

}  // namespace rayleaf
