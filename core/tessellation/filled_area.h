// Triangles between closed polygons of a plane: outlines run counter-clockwise, holes clockwise.
//
// Holes are joined to the outline around them by a bridge of two opposite edges, and the resulting polygon is clipped
// ear by ear (Eberly, "Triangulation by Ear Clipping", 2002). Every vertex stays a corner, so the triangles share their
// border with everything else that begins at the polygons. Where polygons cross (chords of neighbouring curves may,
// from afar) no triangulation is right: then some triangles lie outside the area or are turned.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace rayleaf {

/// Integer numbers of steps of the local space's grid (tessellation/grid.h): their differences are exact.
struct AreaPoint {
    double x = 0, y = 0;
    bool operator==(const AreaPoint&) const = default;
};

/// Corners as indices into `points`. Polygon k has the points from begins[k] on, up to begins[k + 1]; the last entry is
/// their number.
std::vector<std::array<uint32_t, 3>> triangles_of_area(std::span<const AreaPoint> points,
                                                       std::span<const uint32_t> begins);

}  // namespace rayleaf
