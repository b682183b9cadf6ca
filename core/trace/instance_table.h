// The instances of a scene as rays meet them: placed, with the tree above them. A table that one tracer no longer needs
// is what the next one begins with: an edit changes what differs.
#pragma once

#include "base/chunked_vector.h"
#include "base/spares.h"
#include "trace/box_tree.h"
#include "trace/dicing.h"
#include "trace/instance_record.h"
#include "trace/oriented_boxes.h"
#include "trace/shape_scene.h"
#include "trace/tracer.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace rayleaf {

class TracedShapeStore;

/// What the tree above the instances holds.
struct TreeItem {
    uint32_t instance = 0;
    uint32_t root = 0;  ///< of the part of its shape that the item is (ShapePart), or 0
    int part = -1;      ///< among ShapeScene::parts; -1: the instance as a whole
};

/// Below, `of shapes`: by the number of a shape, in the order in which instances first have them.
struct InstanceTable {
    ChunkedVector<TracedInstance> instances;
    std::vector<uint32_t> shape_of;                    ///< of each instance, its shape
    std::vector<std::shared_ptr<const Shape>> unique;  ///< of each content the first
    std::vector<ShapeTolerance> tolerances;            ///< of shapes
    std::vector<std::shared_ptr<ShapeScene>> shapes;   ///< the same as they are traced
    uint64_t kept_shapes = 0;                          ///< those that were not built for this tracer
    std::vector<InstanceRecord> records;
    std::vector<Box3d> boxes;  ///< of instances in the world, of whole motions where they move
    uint32_t moving = 0;       ///< instances that do
    Box3d bounds;
    LocalFrame frame;                   ///< world -> the space of the tree
    BoxTree tree;                       ///< above the instances; empty where there are few
    std::vector<OrientedBoxes> leaves;  ///< of the tree, in that space
    std::vector<TreeItem> items;        ///< what the boxes of the leaves hold: OrientedBoxes::kMost places a leaf

    std::span<const TreeItem> items_in(uint32_t leaf) const {
        return {items.data() + size_t{leaf} * OrientedBoxes::kMost, leaves[leaf].count};
    }

    /// Makes it the table of these instances. `store` may be null. After an exception, Cancelled too, it is of no use.
    void update(ChunkedVector<TracedInstance> instances_now, const DicingView& view_now, uint64_t resident_budget,
                TracedShapeStore* store, const CancelToken& cancel);
    /// Instances that the tree holds in parts.
    size_t opened() const;
    /// How many chunks of instances it has in common with others.
    size_t likeness(const ChunkedVector<TracedInstance>& others) const;
    /// Once instances ask other ray caches than before, or none: a cache is told of all rays that meet the box of the
    /// whole shape.
    void take_caches(std::span<const uint32_t> of);

  private:
    DicingView view_;
    uint64_t resident_budget_ = 0;
    uint32_t moved_ = 0;                ///< instances since the tree was built
    std::vector<uint32_t> first_item_;  ///< of each instance, in `place_`, and at the end its size
    std::vector<uint32_t> place_;       ///< among `items`, instance after instance; kNoPlace: nothing to hit

    /// What an update has found.
    struct Changes {
        std::vector<uint32_t> items;         ///< instances that are others, or elsewhere
        std::vector<uint8_t> of_shapes;      ///< shapes that are traced as another scene than before
        std::vector<uint8_t> of_tolerances;  ///< shapes of which the tolerance is not known
    };
    void number_shapes(Changes& changes, bool same_view);
    void number_shapes_anew();
    void find_tolerances(const Changes& changes);
    void trace_shapes(Changes& changes, TracedShapeStore* store, const CancelToken& cancel);
    std::vector<uint32_t> place_instances(const Changes& changes);
    void set_bounds();
    bool frame_holds() const;
    void renew_tree(std::span<const uint32_t> placed, const CancelToken& cancel);
    void build_tree(std::span<const uint8_t> open, const CancelToken& cancel);
    bool refit_tree(std::span<const uint32_t> placed);
    std::vector<uint8_t> choose_open() const;
    void add_items(uint32_t instance, bool open, std::vector<TreeItem>& all) const;
    bool renew_items_of(uint32_t instance);
    std::vector<uint32_t> leaves_of(std::span<const uint32_t> instances_in_tree) const;
    void renew_leaf(uint32_t leaf);
    std::span<const uint32_t> places_of(uint32_t instance) const {
        return std::span(place_).subspan(first_item_[instance], first_item_[instance + 1] - first_item_[instance]);
    }
    bool is_open(uint32_t instance) const { return first_item_[instance + 1] - first_item_[instance] > 1; }
    Box3f box_in_tree(const TreeItem& item) const;
    OrientedBox oriented_in_tree(const TreeItem& item) const;
};

}  // namespace rayleaf
