// The tree above the instances: what its leaves hold, how it is built, and how it follows edits.
#include "trace/instance_table.h"

#include <algorithm>
#include <functional>
#include <numeric>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// Up to so many instances are asked one after the other, without a tree above them.
constexpr size_t kDirectInstances = 3;

/// The place of an item that has none.
constexpr uint32_t kNoPlace = ~0u;

/// A tree is built anew once so large a share of the instances has moved in it.
constexpr uint32_t kMovedShare = 8;

double half_area_of(const OrientedBox& box) {
    return half_area(Box3d(Vec3d(box.low[0], box.low[1], box.low[2]), Vec3d(box.high[0], box.high[1], box.high[2])));
}

const ShapePart& part_of(const InstanceRecord& record, int part) {
    return record.scene->parts()[static_cast<size_t>(part)];
}

Box3d part_in_world(const InstanceRecord& record, int part) {
    return image_of(part_of(record, part).box, record.local_to_world);
}

bool may_be_open(const InstanceRecord& record) {
    return !record.motion && !record.cache && record.scene->parts().size() > 1;
}

}  // namespace

/// Whether the space of the tree still fits.
bool InstanceTable::frame_holds() const {
    if (bounds.isEmpty()) return false;
    const double reach = std::max(max_abs(bounds.min - frame.center), max_abs(bounds.max - frame.center));
    return reach <= frame.scale && 2.0 * LocalFrame::fitting(bounds).scale >= frame.scale;
}

/// Empty where there is nothing to hit.
Box3f InstanceTable::box_in_tree(const TreeItem& item) const {
    const Box3d box = item.part < 0 ? boxes[item.instance] : part_in_world(records[item.instance], item.part);
    if (box.isEmpty()) return {};
    const Vec3f padding(static_cast<float>(kBoxPadding));
    return {frame.to_local(box.min) - padding, frame.to_local(box.max) + padding};
}

/// Along the axes of the tree, where the other would be larger or the instance moves. A ray cache is asked by all rays
/// that meet the shape's box.
OrientedBox InstanceTable::oriented_in_tree(const TreeItem& item) const {
    const InstanceRecord& record = records[item.instance];
    const Box3f upright = box_in_tree(item);
    OrientedBox straight{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                         {upright.min.x, upright.min.y, upright.min.z},
                         {upright.max.x, upright.max.y, upright.max.z},
                         true};
    if (record.motion) return straight;
    const SnugBox box = item.part >= 0 ? SnugBox(part_of(record, item.part).box)
                        : record.cache ? SnugBox(record.scene->box())
                                       : record.scene->snug_box();
    OrientedBox turned{};
    const Vec3d center = record.point_to_local(frame.center);
    const RayMap& map = record.to_local;
    for (size_t i = 0; i < 3; ++i) {
        const Vec3d& axis = box.axis[i];
        const Vec3d row = Vec3d(axis.dot(map.x), axis.dot(map.y), axis.dot(map.z)) * frame.scale;
        const double length = row.length();
        turned.axis[i] = Vec3f(row / length);
        turned.low[i] = static_cast<float>((box.low[i] - axis.dot(center)) / length - 2.0 * kBoxPadding);
        turned.high[i] = static_cast<float>((box.high[i] - axis.dot(center)) / length + 2.0 * kBoxPadding);
    }
    return half_area_of(turned) < half_area_of(straight) ? turned : straight;
}

/// Of instances whose parts fill little of their boxes, like curves, the tree holds the parts: where such boxes
/// overlap, a ray meets what is near first, and few of the others. The largest instances are opened first, as rays meet
/// them most (C. Benthin, S. Woop, I. Wald, A. Áfra: Improved Two-Level BVHs using Partial Re-Braiding, HPG 2017).
std::vector<uint8_t> InstanceTable::choose_open() const {
    constexpr size_t kMostOpened = 512;
    std::vector<uint32_t> largest(instances.size());
    std::iota(largest.begin(), largest.end(), 0u);
    std::erase_if(largest, [this](uint32_t i) { return !may_be_open(records[i]); });
    std::ranges::stable_sort(largest, std::greater<>(), [this](uint32_t i) { return half_area(boxes[i]); });
    largest.resize(std::min(largest.size(), kMostOpened));
    std::vector<uint8_t> open(instances.size());
    tbb::parallel_for(size_t{0}, largest.size(), [&](size_t k) {
        const InstanceRecord& record = records[largest[k]];
        double of_parts = 0.0;
        for (size_t part = 0; part < record.scene->parts().size(); ++part)
            of_parts += half_area(part_in_world(record, static_cast<int>(part)));
        open[largest[k]] = of_parts < half_area(boxes[largest[k]]) ? 1 : 0;
    });
    return open;
}

/// What the tree holds of an instance.
void InstanceTable::add_items(uint32_t instance, bool open, std::vector<TreeItem>& all) const {
    if (!open) {
        all.push_back({instance});
        return;
    }
    int number = 0;
    for (const ShapePart& part : records[instance].scene->parts()) all.push_back({instance, part.root, number++});
}

/// Where they were. False where that cannot be.
bool InstanceTable::renew_items_of(uint32_t instance) {
    const bool open = is_open(instance);
    if (open && !may_be_open(records[instance])) return false;
    std::vector<TreeItem> all;
    add_items(instance, open, all);
    const std::span<const uint32_t> places = places_of(instance);
    if (all.size() != places.size()) return false;
    for (size_t i = 0; i < all.size(); ++i) {
        if (places[i] == kNoPlace || box_in_tree(all[i]).isEmpty()) return false;
        items[places[i]] = all[i];
    }
    return true;
}

/// Each once.
std::vector<uint32_t> InstanceTable::leaves_of(std::span<const uint32_t> instances_in_tree) const {
    std::vector<uint32_t> all;
    for (const uint32_t i : instances_in_tree)
        for (const uint32_t place : places_of(i))
            if (place != kNoPlace) all.push_back(place / OrientedBoxes::kMost);
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

void InstanceTable::renew_leaf(uint32_t leaf) {
    const std::span<const TreeItem> held = items_in(leaf);
    for (uint32_t i = 0; i < held.size(); ++i) leaves[leaf].set(i, oriented_in_tree(held[i]));
}

size_t InstanceTable::opened() const {
    if (tree.empty()) return 0;
    size_t count = 0;
    for (uint32_t i = 0; i < instances.size(); ++i) count += is_open(i) ? 1 : 0;
    return count;
}

void InstanceTable::take_caches(std::span<const uint32_t> of) {
    if (tree.empty()) return;
    const std::vector<uint8_t> open = choose_open();
    for (uint32_t i = 0; i < instances.size(); ++i)
        if (is_open(i) != (open[i] != 0)) return build_tree(open, kNeverCancelled);
    for (const uint32_t leaf : leaves_of(of)) renew_leaf(leaf);
}

void InstanceTable::renew_tree(std::span<const uint32_t> placed, const CancelToken& cancel) {
    const auto count = static_cast<uint32_t>(instances.size());
    moved_ += static_cast<uint32_t>(std::min<size_t>(placed.size(), count));
    if (!tree.empty() && moved_ <= count / kMovedShare && frame_holds() && refit_tree(placed)) return;
    frame = LocalFrame::fitting(bounds);
    moved_ = 0;
    tree = {};
    leaves.clear();
    items.clear();
    if (count > kDirectInstances && !bounds.isEmpty()) build_tree(choose_open(), cancel);
}

void InstanceTable::build_tree(std::span<const uint8_t> open, const CancelToken& cancel) {
    std::vector<TreeItem> all;  // instance after instance
    first_item_.assign(1, 0);
    for (uint32_t i = 0; i < instances.size(); ++i) {
        add_items(i, open[i] != 0, all);
        first_item_.push_back(static_cast<uint32_t>(all.size()));
    }
    BoxLeaves held;
    tree = BoxTree(
        static_cast<uint32_t>(all.size()), [&](uint32_t i) { return box_in_tree(all[i]); }, cancel,
        OrientedBoxes::kMost, held);
    place_.assign(all.size(), kNoPlace);
    leaves.assign(held.count(), {});
    items.assign(leaves.size() * OrientedBoxes::kMost, {});
    tbb::parallel_for(0u, held.count(), [&](uint32_t leaf) {
        const uint32_t first = held.first[leaf];
        leaves[leaf].count = held.first[leaf + 1] - first;
        for (uint32_t i = 0; i < leaves[leaf].count; ++i) {
            const uint32_t item = held.items[first + i];
            place_[item] = leaf * OrientedBoxes::kMost + i;
            items[place_[item]] = all[item];
        }
        renew_leaf(leaf);
    });
}

/// False where it must be built anew.
bool InstanceTable::refit_tree(std::span<const uint32_t> placed) {
    for (const uint32_t i : placed)
        if (!renew_items_of(i)) return false;
    const std::vector<uint32_t> moved = leaves_of(placed);
    for (const uint32_t leaf : moved) renew_leaf(leaf);
    tree.refit(moved, [this](uint32_t leaf) {
        Box3f box;
        for (const TreeItem& item : items_in(leaf)) box.extendBy(box_in_tree(item));
        return box;
    });
    return true;
}

}  // namespace rayleaf
