// Boxes of parts of a shape that together hold all of it. The box of an instance that is turned is smaller around their
// images than around the image of the whole shape's box.
#pragma once

#include "base/vector.h"
#include "geometry/triangle_mesh.h"
#include "trace/box_tree.h"

#include <cstdint>
#include <span>
#include <vector>

namespace rayleaf {

/// At most so many.
inline constexpr size_t kMostParts = 32;

/// Of what is in a tree: the boxes of its topmost nodes.
std::vector<Box3d> part_boxes(const BoxTree& tree);
/// Of a mesh, at all times: triangles are put together by where their boxes' middles lie.
std::vector<Box3d> part_boxes(const TriangleMesh& mesh);

/// Of one triangle, at all times.
Box3d triangle_box(const TriangleMesh& mesh, uint32_t triangle);

/// Bounds of the images of boxes.
Box3d image_of(std::span<const Box3d> parts, const Affine3d& map);

}  // namespace rayleaf
