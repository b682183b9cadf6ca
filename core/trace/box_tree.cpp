#include "trace/box_tree.h"

#include "trace/embree.h"

#include <algorithm>
#include <memory>
#include <vector>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// What Embree makes: a node, or an item.
struct Part {
    uint32_t leaf = 0;  ///< BoxNode::kLeaf | number of the item; 0 for nodes
};
struct Node : Part {
    BoxNode boxes;
    const Part* children[BoxNode::kMostChildren];
};

void* create_node(RTCThreadLocalAllocator allocator, unsigned count, void*) {
    auto* node = new (rtcThreadLocalAlloc(allocator, sizeof(Node), alignof(Node))) Node;
    node->boxes = {};  // also of the children that there are not
    node->boxes.count = count;
    return node;
}

void set_children(void* parent, void** children, unsigned count, void*) {
    for (unsigned i = 0; i < count; ++i)
        static_cast<Node*>(parent)->children[i] = static_cast<const Part*>(children[i]);
}

void set_box(BoxNode& node, unsigned child, const RTCBounds& box) {
    const float sides[3][2] = {{box.lower_x, box.upper_x}, {box.lower_y, box.upper_y}, {box.lower_z, box.upper_z}};
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) node.bounds[axis][side][child] = sides[axis][side];
}

void set_bounds(void* parent, const RTCBounds** boxes, unsigned count, void*) {
    for (unsigned i = 0; i < count; ++i) set_box(static_cast<Node*>(parent)->boxes, i, *boxes[i]);
}

void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* items, size_t, void*) {
    auto* leaf = new (rtcThreadLocalAlloc(allocator, sizeof(Part), alignof(Part))) Part;
    leaf->leaf = BoxNode::kLeaf | items[0].primID;
    return leaf;
}

/// Copies a node and all below it, parents before children; returns its number.
uint32_t add_nodes(const Node& from, std::vector<BoxNode>& nodes) {
    const auto number = static_cast<uint32_t>(nodes.size());
    nodes.push_back(from.boxes);
    for (uint32_t i = 0; i < from.boxes.count; ++i) {
        const Part& child = *from.children[i];
        nodes[number].child[i] = child.leaf != 0 ? child.leaf : add_nodes(static_cast<const Node&>(child), nodes);
    }
    return number;
}

struct ReleaseTree {
    void operator()(RTCBVH tree) const { rtcReleaseBVH(tree); }
};

std::vector<RTCBuildPrimitive> build_items(uint32_t count, const std::function<Box3f(uint32_t)>& box_of) {
    std::vector<RTCBuildPrimitive> items(count);
    tbb::parallel_for(uint32_t{0}, count, [&](uint32_t i) {
        const Box3f box = box_of(i);
        items[i] = {box.min.x, box.min.y, box.min.z, 0, box.max.x, box.max.y, box.max.z, i};
    });
    std::erase_if(items, [](const RTCBuildPrimitive& item) { return item.lower_x > item.upper_x; });
    return items;
}

}  // namespace

BoxTree::BoxTree(uint32_t count, const std::function<Box3f(uint32_t)>& box_of, const CancelToken& cancel) {
    std::vector<RTCBuildPrimitive> items = build_items(count, box_of);
    if (items.empty()) return;
    if (items.size() == 1) {
        nodes_ = LargeArray<BoxNode>(1);
        BoxNode& root = nodes_[0] = {};
        const RTCBuildPrimitive& item = items[0];
        set_box(root, 0, {item.lower_x, item.lower_y, item.lower_z, 0, item.upper_x, item.upper_y, item.upper_z, 0});
        root.child[0] = BoxNode::kLeaf | item.primID;
        root.count = 1;
        return;
    }
    const std::unique_ptr<std::remove_pointer_t<RTCBVH>, ReleaseTree> tree(rtcNewBVH(embree_device()));
    RTCBuildArguments arguments = rtcDefaultBuildArguments();
    arguments.maxBranchingFactor = BoxNode::kMostChildren;
    arguments.maxDepth = BoxNode::kDeepest;
    arguments.maxLeafSize = 1;
    arguments.bvh = tree.get();
    arguments.primitives = items.data();
    arguments.primitiveCount = arguments.primitiveArrayCapacity = items.size();
    arguments.createNode = create_node;
    arguments.setNodeChildren = set_children;
    arguments.setNodeBounds = set_bounds;
    arguments.createLeaf = create_leaf;
    arguments.buildProgress = embree_goes_on;
    arguments.userPtr = const_cast<CancelToken*>(&cancel);
    const void* root = rtcBuildBVH(&arguments);
    throw_embree_error();
    std::vector<BoxNode> nodes;
    add_nodes(*static_cast<const Node*>(root), nodes);
    nodes_ = LargeArray<BoxNode>(nodes.size());
    std::copy(nodes.begin(), nodes.end(), nodes_.data());
}

}  // namespace rayleaf
