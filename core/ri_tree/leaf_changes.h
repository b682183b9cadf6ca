// Derivatives of a leaf's answer: the leaf's polynomials, differentiated along the two steps of a ray's differential.
// Local space.
#pragma once

#include "rays/hit.h"
#include "rays/ray_differential.h"
#include "ri_tree/line_batch.h"
#include "ri_tree/path_changes.h"

namespace rayleaf {

/// The picture's x and y.
inline constexpr int kPictureSteps = 2;
/// Steps along the line axes, in the coordinates of a cell, which are -1 to 1.
struct StepsInCell {
    float steps[kPictureSteps][kLineAxes] = {};
};

/// The steps that a ray from `from_center` (relative to the box's middle) makes in a cell.
StepsInCell steps_in_cell(const BatchFrame& frame, const CellPlace& cell, const LineGeometry& line,
                          const Vec3d& from_center, const RayDifferential& differential);

/// The derivatives of the output ray `out` for those of the leaf's values. Unknown where they would not be finite.
HitChanges output_changes(OutputKind kind, const CellLeaf& leaf, const float (&changes)[kPictureSteps][kLeafPadding],
                          const OutputRay& out);

/// Derivatives of an output ray, local units, by the picture's x and y: the first two entries of `changes`.
HitChanges hit_changes(const OutputChanges& changes, double scale);

}  // namespace rayleaf
