// Normals of a polygon mesh's vertices, as Blender shades with.
#pragma once

#include "base/vector.h"

#include <cstdint>
#include <span>
#include <vector>

namespace rayleaf {

/// Unit; the mean of the faces around a vertex by the angles of their corners there, as Blender has it; of a vertex
/// without faces of any area along its place, zero at the origin. `corners`: of the faces, one after the other, the
/// vertices.
///
/// Blender before 4.1 adds up in the order in which its threads come, so its own differ between renders in the last
/// digits. These are sums of integers, which any order leaves the same.
std::vector<Vec3f> vertex_normals(std::span<const Vec3f> vertices, std::span<const int32_t> face_sizes,
                                  std::span<const int32_t> corners);

}  // namespace rayleaf
