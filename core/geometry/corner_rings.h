// What lies around the corners of a cage's face, as far as all of it is smooth.
#pragma once

#include "geometry/face_cage.h"
#include "geometry/limit_quadtree.h"

#include <optional>

namespace rayleaf {

/// Empty where a corner has a border, a crease, fewer than three faces, or faces that are not one closed ring of the
/// same winding. `values` by vertex.
std::optional<std::vector<CornerRing>> corner_rings(const FaceCage::Level& level, int face,
                                                    std::span<const Vec3d> values);

}  // namespace rayleaf
