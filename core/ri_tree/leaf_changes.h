// How what a leaf says changes with its line: the leaf's polynomials, differentiated along the steps of a ray's
// differential. Local space.
#pragma once

#include "rays/hit.h"
#include "rays/ray_differential.h"
#include "ri_tree/line_batch.h"
#include "ri_tree/path_changes.h"

namespace rayleaf {

/// A picture's x and y.
inline constexpr int kPictureSteps = 2;
/// Along the line axes, in the coordinates of a cell, which are -1 to 1.
struct StepsInCell {
    float steps[kPictureSteps][kLineAxes] = {};
};

/// The steps that a ray from `from_center` (relative to the box's middle) makes in a cell.
StepsInCell steps_in_cell(const BatchFrame& frame, const CellPlace& cell, const LineGeometry& line,
                          const Vec3d& from_center, const RayDifferential& differential);

/// What leaf values that change by `changes` make of the output ray `out`. Unknown where it would not be finite.
HitChanges output_changes(OutputKind kind, const CellLeaf& leaf, const float (&changes)[kPictureSteps][kLeafPadding],
                          const OutputRay& out);

/// Changes of an output ray, in local units, by the picture's x and y, as its first two lines' coordinates.
HitChanges hit_changes(const OutputChanges& changes, double scale);

}  // namespace rayleaf
