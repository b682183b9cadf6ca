// What a render neither allocated nor ran, because its scene and settings do not need it.
#pragma once

#include "film/film.h"
#include "geometry/shape.h"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace rayleaf {

struct RenderStatistics;

/// The shapes of one kind; each counts once, however many instances it has.
struct ShapeShare {
    size_t shapes = 0, bytes = 0;
};
using ShapeShares = std::array<ShapeShare, kShapeKinds>;  ///< by ShapeKind

/// "triangles", "spline_surfaces", ... in the order of ShapeKind, as the statistics name them.
const char* shape_kind_name(ShapeKind kind);

/// One name for each subsystem that had no memory and no call.
std::vector<std::string> left_out(const RenderStatistics& statistics, const Film& film);

}  // namespace rayleaf
