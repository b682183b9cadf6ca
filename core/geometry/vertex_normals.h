// Normals of a polygon mesh's vertices, as Blender shades with.
#pragma once

#include "base/vector.h"

#include <cstdint>
#include <span>
#include <vector>

namespace rayleaf {

/// Unit: the mean of the normals of the faces around each vertex, weighed by the angles of their corners there, as in
/// Blender. A vertex without such faces gets the direction from the origin to it; at the origin, zero. Faces without an
/// area, and those with a vertex that is not finite, do not count. `corners`: the faces' vertices, face after face.
///
/// Blender before 4.1 adds up in the order in which its threads come, so its own differ between renders in the last
/// digits. These are sums of integers, which any order leaves the same.
std::vector<Vec3f> vertex_normals(std::span<const Vec3f> vertices, std::span<const int32_t> face_sizes,
                                  std::span<const int32_t> corners);

}  // namespace rayleaf
