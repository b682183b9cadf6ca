#include "trace/box_tree.h"

#include "base/assert.h"
#include "trace/embree.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <vector>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// What Embree makes: a node, or a leaf.
struct BuildPart {
    bool is_leaf = false;
};
struct Node : BuildPart {
    BoxNode boxes;
    const BuildPart* children[BoxNode::kMostChildren];
};
struct Leaf : BuildPart {
    uint32_t count = 0;
    uint32_t items[BoxTree::kMostInLeaf];
};

/// What the callbacks share.
struct Build {
    const CancelToken& cancel;
    bool has_leaves;  ///< of several items; else each item hangs from a node
    std::atomic<uint32_t> nodes{0};
};

/// Ends a build: this kind of build calls back to say how far it is, but does not read the answer. Embree catches what
/// is thrown in its callbacks.
bool goes_on(void* build, double /*share*/) {
    static_cast<const Build*>(build)->cancel.throw_if_cancelled();
    return true;
}

Node* new_node(RTCThreadLocalAllocator allocator, uint32_t count, Build& build) {
    build.cancel.throw_if_cancelled();
    build.nodes.fetch_add(1, std::memory_order_relaxed);  // read when all threads have ended
    auto* node = new (rtcThreadLocalAlloc(allocator, sizeof(Node), alignof(Node))) Node;
    node->boxes = {};  // also of the children that there are not
    node->boxes.count = count;
    return node;
}

void* create_node(RTCThreadLocalAllocator allocator, unsigned count, void* user) {
    return static_cast<BuildPart*>(new_node(allocator, count, *static_cast<Build*>(user)));
}

/// Embree is given parts.
Node& node_at(void* part) {
    return static_cast<Node&>(*static_cast<BuildPart*>(part));
}

void set_children(void* parent, void** children, unsigned count, void*) {
    for (unsigned i = 0; i < count; ++i) node_at(parent).children[i] = static_cast<const BuildPart*>(children[i]);
}

void set_box(BoxNode& node, unsigned child, const RTCBounds& box) {
    const float sides[3][2] = {{box.lower_x, box.upper_x}, {box.lower_y, box.upper_y}, {box.lower_z, box.upper_z}};
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) node.bounds[axis][side][child] = sides[axis][side];
}

void set_bounds(void* parent, const RTCBounds** boxes, unsigned count, void*) {
    for (unsigned i = 0; i < count; ++i) set_box(node_at(parent).boxes, i, *boxes[i]);
}

Leaf* new_leaf(RTCThreadLocalAllocator allocator, std::span<const RTCBuildPrimitive> items) {
    auto* leaf = new (rtcThreadLocalAlloc(allocator, sizeof(Leaf), alignof(Leaf))) Leaf;
    leaf->is_leaf = true;
    leaf->count = static_cast<uint32_t>(items.size());
    for (size_t i = 0; i < items.size(); ++i) leaf->items[i] = items[i].primID;
    std::sort(leaf->items, leaf->items + items.size());
    return leaf;
}

/// What Embree takes for a leaf of several items.
Node* node_of_items(RTCThreadLocalAllocator allocator, std::span<const RTCBuildPrimitive> items, Build& build) {
    Node* node = new_node(allocator, static_cast<uint32_t>(items.size()), build);
    std::array<RTCBuildPrimitive, BoxNode::kMostChildren> sorted;
    std::ranges::partial_sort_copy(items, sorted, {}, &RTCBuildPrimitive::primID, &RTCBuildPrimitive::primID);
    for (unsigned i = 0; i < items.size(); ++i) {
        const RTCBuildPrimitive& item = sorted[i];
        set_box(node->boxes, i,
                {item.lower_x, item.lower_y, item.lower_z, 0.0f, item.upper_x, item.upper_y, item.upper_z, 0.0f});
        node->children[i] = new_leaf(allocator, {&item, 1});
    }
    return node;
}

void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* items, size_t count, void* user) {
    Build& build = *static_cast<Build*>(user);
    if (count == 1 || build.has_leaves) return static_cast<BuildPart*>(new_leaf(allocator, {items, count}));
    return static_cast<BuildPart*>(node_of_items(allocator, {items, count}, build));
}

/// Copies a tree, parents before children. Without `leaves`, each leaf has one item and gets its number.
struct TreeCopy {
    LargeArray<BoxNode> nodes;
    BoxLeaves* leaves;
    const CancelToken& cancel;
    uint32_t count = 0;

    uint32_t add(const BuildPart& part) {
        return part.is_leaf ? BoxNode::kLeaf | add_leaf(static_cast<const Leaf&>(part))
                            : add_node(static_cast<const Node&>(part));
    }
    uint32_t add_leaf(const Leaf& leaf) {
        if (!leaves) return leaf.items[0];
        leaves->items.insert(leaves->items.end(), leaf.items, leaf.items + leaf.count);
        leaves->first.push_back(static_cast<uint32_t>(leaves->items.size()));
        return leaves->count() - 1;
    }
    uint32_t add_node(const Node& node) {
        cancel.throw_if_cancelled();
        const uint32_t number = count++;
        nodes[number] = node.boxes;
        for (uint32_t i = 0; i < node.boxes.count; ++i) {
            const uint32_t child = add(*node.children[i]);
            nodes[number].child[i] = child;
        }
        return number;
    }
    /// A tree that is no more than a leaf.
    void add_root(const Leaf& leaf, const RTCBounds& box) {
        nodes[0] = {};
        set_box(nodes[0], 0, box);
        nodes[0].child[0] = add(leaf);
        nodes[0].count = 1;
    }
};

struct ReleaseTree {
    void operator()(RTCBVH tree) const { rtcReleaseBVH(tree); }
};

/// What the tree is built of. Embree moves them about.
struct BuildItems {
    LargeArray<RTCBuildPrimitive> all;
    size_t count = 0;  ///< of those that have a box; they come first
};

BuildItems build_items(uint32_t count, const std::function<Box3f(uint32_t)>& box_of, const CancelToken& cancel) {
    BuildItems items{LargeArray<RTCBuildPrimitive>(count), count};
    std::atomic<bool> any_empty{false};
    tbb::parallel_for(uint32_t{0}, count, [&](uint32_t i) {
        cancel.throw_if_cancelled();
        const Box3f box = box_of(i);
        items.all[i] = {box.min.x, box.min.y, box.min.z, 0, box.max.x, box.max.y, box.max.z, i};
        if (box.isEmpty()) any_empty.store(true, std::memory_order_relaxed);  // read when all threads have ended
    });
    if (any_empty) {
        const auto is_empty = [](const RTCBuildPrimitive& item) { return item.lower_x > item.upper_x; };
        RTCBuildPrimitive* const first = items.all.data();
        items.count = static_cast<size_t>(std::remove_if(first, first + count, is_empty) - first);
    }
    return items;
}

RTCBounds box_around(const BuildItems& items) {
    Box3f box;
    for (size_t i = 0; i < items.count; ++i) {
        const RTCBuildPrimitive& item = items.all[i];
        box.extendBy(Vec3f(item.lower_x, item.lower_y, item.lower_z));
        box.extendBy(Vec3f(item.upper_x, item.upper_y, item.upper_z));
    }
    return {box.min.x, box.min.y, box.min.z, 0.0f, box.max.x, box.max.y, box.max.z, 0.0f};
}

LargeArray<BoxNode> build(BuildItems items, const CancelToken& cancel, uint32_t most_in_leaf, BoxLeaves* leaves) {
    if (leaves) leaves->first.assign(1, 0);
    if (items.count == 0) return {};
    if (leaves) leaves->items.reserve(items.count);
    const std::unique_ptr<std::remove_pointer_t<RTCBVH>, ReleaseTree> tree(rtcNewBVH(embree_device()));
    RTCBuildArguments arguments = rtcDefaultBuildArguments();
    arguments.maxBranchingFactor = BoxNode::kMostChildren;
    arguments.maxDepth = BoxNode::kDeepest - 1;  // and a node of items
    // Leaves, and nodes of items, are as full as can be.
    arguments.minLeafSize = arguments.maxLeafSize = leaves ? most_in_leaf : BoxNode::kMostChildren;
    if (leaves) arguments.sahBlockSize = most_in_leaf;  // a leaf's items are tested together
    arguments.bvh = tree.get();
    arguments.primitives = items.all.data();
    arguments.primitiveCount = arguments.primitiveArrayCapacity = items.count;
    arguments.createNode = create_node;
    arguments.setNodeChildren = set_children;
    arguments.setNodeBounds = set_bounds;
    arguments.createLeaf = create_leaf;
    arguments.buildProgress = goes_on;
    Build state{cancel, leaves != nullptr};
    arguments.userPtr = &state;
    const auto* root = static_cast<const BuildPart*>(rtcBuildBVH(&arguments));
    if (cancel.cancelled()) {
        rtcGetDeviceError(embree_device());  // it is not an error
        throw Cancelled();
    }
    throw_embree_error();
    TreeCopy copy{LargeArray<BoxNode>(std::max(state.nodes.load(), 1u)), leaves, cancel};
    if (root->is_leaf)
        copy.add_root(static_cast<const Leaf&>(*root), box_around(items));
    else
        copy.add(*root);
    RAYLEAF_ASSERT_EQ(root->is_leaf ? 0 : copy.count, state.nodes.load());
    return std::move(copy.nodes);
}

/// The number of what a node or item hangs from, where it hangs from nothing.
constexpr uint32_t kNowhere = ~0u;

unsigned child_place(const BoxNode& node, uint32_t child) {
    return static_cast<unsigned>(std::find(node.child, node.child + node.count, child) - node.child);
}

RTCBounds box_of_children(const BoxNode& node) {
    const auto low = [&](int axis) {
        return *std::min_element(node.bounds[axis][0], node.bounds[axis][0] + node.count);
    };
    const auto high = [&](int axis) {
        return *std::max_element(node.bounds[axis][1], node.bounds[axis][1] + node.count);
    };
    return {low(0), low(1), low(2), 0.0f, high(0), high(1), high(2), 0.0f};
}

}  // namespace

BoxTree::BoxTree(uint32_t count, const std::function<Box3f(uint32_t)>& box_of, const CancelToken& cancel)
    : BoxTree(build(build_items(count, box_of, cancel), cancel, 1, nullptr)) {}

BoxTree::BoxTree(uint32_t count, const std::function<Box3f(uint32_t)>& box_of, const CancelToken& cancel,
                 uint32_t most_in_leaf, BoxLeaves& leaves)
    : BoxTree(build(build_items(count, box_of, cancel), cancel, most_in_leaf, &leaves)) {}

LargeArray<BoxBounds> BoxTree::moving_bounds(size_t steps, const std::function<Box3f(uint32_t, size_t)>& box_of) const {
    LargeArray<BoxBounds> all(nodes_.size() * steps);
    tbb::parallel_for(size_t{0}, steps, [&](size_t step) {
        std::vector<Box3f> boxes(nodes_.size());
        for (size_t number = nodes_.size(); number-- > 0;) {  // parents come before their children
            const BoxNode& node = nodes_[number];
            BoxBounds& bounds = all[number * steps + step] = {};
            for (uint32_t i = 0; i < node.count; ++i) {
                const uint32_t child = node.child[i];
                const Box3f box = (child & BoxNode::kLeaf) != 0 ? box_of(child & ~BoxNode::kLeaf, step) : boxes[child];
                boxes[number].extendBy(box);
                for (int axis = 0; axis < 3; ++axis) {
                    bounds.bounds[axis][0][i] = box.min[axis];
                    bounds.bounds[axis][1][i] = box.max[axis];
                }
            }
        }
    });
    return all;
}

void BoxTree::find_parents() {
    parent_.assign(nodes_.size(), kNowhere);
    for (uint32_t node = 0; node < nodes_.size(); ++node) {
        for (uint32_t i = 0; i < nodes_[node].count; ++i) {
            const uint32_t child = nodes_[node].child[i];
            if ((child & BoxNode::kLeaf) == 0) {
                parent_[child] = node;
                continue;
            }
            const uint32_t leaf = child & ~BoxNode::kLeaf;
            if (leaf >= node_of_leaf_.size()) node_of_leaf_.resize(leaf + 1, kNowhere);
            node_of_leaf_[leaf] = node;
        }
    }
}

void BoxTree::refit(std::span<const uint32_t> leaves, const std::function<Box3f(uint32_t)>& box_of) {
    if (parent_.empty()) find_parents();
    for (const uint32_t leaf : leaves) {
        const Box3f box = box_of(leaf);
        uint32_t child = BoxNode::kLeaf | leaf, node = node_of_leaf_[leaf];
        RTCBounds bounds{box.min.x, box.min.y, box.min.z, 0.0f, box.max.x, box.max.y, box.max.z, 0.0f};
        while (node != kNowhere) {
            set_box(nodes_[node], child_place(nodes_[node], child), bounds);
            bounds = box_of_children(nodes_[node]);
            child = node;
            node = parent_[node];
        }
    }
}

}  // namespace rayleaf
