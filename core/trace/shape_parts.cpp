#include "trace/shape_parts.h"

#include <algorithm>
#include <array>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

namespace rayleaf {
namespace {

/// Cells along each side of the box of a mesh.
constexpr int kCells = 3;
using CellBoxes = std::array<Box3d, kCells * kCells * kCells>;
static_assert(std::tuple_size_v<CellBoxes> <= kMostParts);

Box3d child_box(const BoxNode& node, uint32_t child) {
    Box3d box;
    for (int axis = 0; axis < 3; ++axis) {
        box.min[axis] = node.bounds[axis][0][child];
        box.max[axis] = node.bounds[axis][1][child];
    }
    return box;
}

size_t cell_of(const Vec3d& point, const Box3d& all) {
    size_t cell = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double size = all.max[axis] - all.min[axis];
        const double share = size > 0.0 ? (point[axis] - all.min[axis]) / size : 0.0;
        cell = cell * kCells + static_cast<size_t>(std::clamp(static_cast<int>(share * kCells), 0, kCells - 1));
    }
    return cell;
}

}  // namespace

Box3d triangle_box(const TriangleMesh& mesh, uint32_t triangle) {
    Box3d box;
    for (size_t step = 0; step < mesh.steps(); ++step) {
        const float time = mesh.deforms() ? time_of_step(step, mesh.steps()) : kMiddleTime;
        for (const Vec3d& corner : mesh.corners(triangle, time)) box.extendBy(corner);
    }
    return box;
}

std::vector<ShapePart> parts_of(const BoxTree& tree) {
    if (tree.empty()) return {};
    std::vector<ShapePart> parts;
    const auto open = [&](uint32_t number) {
        const BoxNode& node = tree.nodes()[number];
        for (uint32_t i = 0; i < node.count; ++i) parts.push_back({child_box(node, i), node.child[i]});
    };
    open(0);
    const auto area = [](const ShapePart& part) {
        return (part.root & BoxNode::kLeaf) != 0 ? 0.0 : half_area(part.box);  // there is nothing to open in a leaf
    };
    while (parts.size() + BoxNode::kMostChildren - 1 <= kMostParts) {
        const auto largest = std::ranges::max_element(parts, {}, area);
        if (!(area(*largest) > 0.0)) break;
        const uint32_t number = largest->root;
        parts.erase(largest);
        open(number);
    }
    return parts;
}

std::vector<ShapePart> parts_of(const TriangleMesh& mesh) {
    const Box3d all(Vec3d(mesh.bounds().min), Vec3d(mesh.bounds().max));
    const auto count = static_cast<uint32_t>(mesh.triangles().size());
    const CellBoxes cells = tbb::parallel_reduce(
        tbb::blocked_range<uint32_t>(0, count, 4096), CellBoxes{},
        [&](const tbb::blocked_range<uint32_t>& range, CellBoxes boxes) {
            for (uint32_t i = range.begin(); i < range.end(); ++i) {
                const Box3d box = triangle_box(mesh, i);
                if (!box.isEmpty()) boxes[cell_of(box.center(), all)].extendBy(box);
            }
            return boxes;
        },
        [](CellBoxes a, const CellBoxes& b) {
            for (size_t i = 0; i < a.size(); ++i) a[i].extendBy(b[i]);
            return a;
        });
    std::vector<ShapePart> parts;
    for (const Box3d& box : cells)
        if (!box.isEmpty()) parts.push_back({box});
    return parts;
}

}  // namespace rayleaf
