// Parts of a shape, which together hold all of it. The box of an instance that is turned is smaller around the images
// of their boxes than around that of the whole shape's box; and the tree above the instances may hold them one by one.
#pragma once

#include "base/vector.h"
#include "geometry/triangle_mesh.h"
#include "trace/box_tree.h"

#include <cstdint>
#include <vector>

namespace rayleaf {

/// At most so many.
inline constexpr size_t kMostParts = 32;

struct ShapePart {
    Box3d box;
    uint32_t root = 0;  ///< the child of a node of the shape's tree that holds it; of a shape without a tree 0
};

/// Of what is in a tree: the topmost nodes, the largest of them opened.
std::vector<ShapePart> parts_of(const BoxTree& tree);
/// Of a mesh, at all times: triangles are put together by where their boxes' middles lie.
std::vector<ShapePart> parts_of(const TriangleMesh& mesh);

/// Of one triangle, at all times.
Box3d triangle_box(const TriangleMesh& mesh, uint32_t triangle);

}  // namespace rayleaf
