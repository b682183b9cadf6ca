// Curves as other primitives, for comparison: strands as tubes of facets, round bevelled curves as strands.
#pragma once

#include "geometry/strands.h"
#include "geometry/swept_surface.h"
#include "geometry/triangle_mesh.h"

#include <memory>
#include <optional>

namespace rayleaf {

/// With more sides or rings a segment is indistinguishable from a round tube.
inline constexpr int kMostTubeDetail = 4096;

/// A tube along every strand: `rings` rings a segment, `sides` vertices a ring, smooth normals, open at its ends.
/// The attributes of strands are not converted.
std::shared_ptr<TriangleMesh> strand_tubes(const Strands& strands, int rings, int sides, FacetLayout layout);

/// The strands along the axes of a bevelled curve whose profile is one full circle; empty where it is not. Segments
/// with weights are followed at their pieces' ends and in the directions there. `spheres` a segment, of the form
/// Spheres.
std::shared_ptr<Strands> strands_along(const SweptCurveDescription& curve, StrandForm form, int spheres);

}  // namespace rayleaf
