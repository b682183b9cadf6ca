#include "trace/instance_table.h"

#include "trace/make_scene.h"
#include "trace/traced_shape_store.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <numeric>
#include <unordered_map>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// Up to so many instances are asked one after the other, without a tree above them.
constexpr size_t kDirectInstances = 3;

/// A tree is built anew once so large a share of the instances has moved in it.
constexpr uint32_t kMovedShare = 8;

bool are_alike(const Shape& a, const Shape& b) {
    return &a == &b || key_of(a, {}) == key_of(b, {});
}

/// A traced shape looks at the shape that it was made of, also in tracers whose instances have another of that content.
struct OwnShapeScene {
    std::shared_ptr<const Shape> shape;
    std::unique_ptr<ShapeScene> scene;
};

struct TracedShapes {
    std::vector<std::shared_ptr<ShapeScene>> all;
    uint64_t kept = 0;  ///< of those
};

/// The shapes as they are traced, those that the store knows from there. It may be null.
TracedShapes traced_shapes(std::span<const std::shared_ptr<const Shape>> unique, std::span<const uint32_t> uses,
                           std::span<const ShapeTolerance> tolerances, double coarsest_cached, uint64_t resident_budget,
                           TracedShapeStore* store, const CancelToken& cancel) {
    const size_t count = unique.size();
    std::vector<TracedShapeKey> keys(count);
    std::vector<KeptShape> kept(count);
    std::vector<std::optional<ShapePlan>> plans(count);
    std::vector<uint64_t> bytes(count);
    if (store) store->next_user();
    WaitingGrids waiting;
    const auto plan = [&](size_t i) { plans[i] = plan_shape(*unique[i], tolerances[i].tolerance, waiting, cancel); };
    tbb::parallel_for(size_t{0}, count, [&](size_t i) {
        if (store) {
            keys[i] = key_of(*unique[i], tolerances[i].key);
            kept[i] = store->find(keys[i]);
        }
        if (!kept[i].scene) plan(i);
        bytes[i] = plans[i] ? plans[i]->resident_bytes() : kept[i].resident_bytes;
    });
    // Grids of the geometry cache have one time: what deforms stays in memory, whatever it takes.
    std::vector<uint64_t> asked = bytes;
    for (size_t i = 0; i < count; ++i) {
        if (!unique[i]->deforms()) continue;
        resident_budget -= std::min(resident_budget, bytes[i]);
        asked[i] = 0;
    }
    const std::vector<Residence> residence = choose_residents(asked, uses, resident_budget);
    std::vector<std::shared_ptr<ShapeScene>> shapes(count);
    std::atomic<uint64_t> found{0};  // read when all are built
    tbb::parallel_for(size_t{0}, count, [&](size_t i) {
        // What goes through the geometry cache has numbers of this tracer; shapes that are not diced take no bytes.
        const bool lasts = bytes[i] == 0 || residence[i] == Residence::Resident;
        if (kept[i].scene && lasts) {
            shapes[i] = std::move(kept[i].scene);
            ++found;
            return;
        }
        if (lasts) {
            if (!plans[i]) plan(i);
        } else {
            const auto tolerance = [&, i](const Box3d& box) {
                return std::min(tolerances[i].tolerance(box), coarsest_cached);
            };
            plans[i] = plan_shape(*unique[i], tolerance, waiting, cancel);
        }
        const auto made = std::make_shared<OwnShapeScene>();
        made->shape = unique[i];
        made->scene = make_scene(std::move(*plans[i]), residence[i], cancel);
        shapes[i] = {made, made->scene.get()};
        if (store && lasts) store->keep(keys[i], {shapes[i], bytes[i]});
    });
    return {std::move(shapes), found};
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

std::vector<uint32_t> all_items(size_t count) {
    std::vector<uint32_t> items(count);
    std::iota(items.begin(), items.end(), 0u);
    return items;
}

}  // namespace

size_t InstanceTable::likeness(const ChunkedVector<TracedInstance>& others) const {
    if (instances.size() != others.size()) return 0;
    size_t alike = 0;
    for (size_t chunk = 0; chunk < instances.chunk_count(); ++chunk) alike += instances.shares(chunk, others) ? 1 : 0;
    return alike;
}

void InstanceTable::update(ChunkedVector<TracedInstance> instances_now, const DicingView& view_now,
                           uint64_t resident_budget, TracedShapeStore* store, const CancelToken& cancel) {
    const bool is_new = instances.size() != instances_now.size() || records.size() != instances_now.size();
    const bool same_view = !is_new && view_ == view_now;
    if (is_new) {
        records.clear();
        boxes.clear();
        moving = 0;
    }
    Changes changes;
    changes.items = is_new ? all_items(instances_now.size()) : differing_items(instances_now, instances);
    instances = std::move(instances_now);
    kept_shapes = shapes.size();
    if (changes.items.empty() && same_view && resident_budget_ == resident_budget) return;
    view_ = view_now;
    resident_budget_ = resident_budget;
    number_shapes(changes, same_view);
    find_tolerances(changes);
    trace_shapes(changes, store, cancel);
    const std::vector<uint32_t> placed = place_instances(changes);
    if (placed.empty()) return;
    set_bounds();
    renew_tree(placed, cancel);
}

/// Shapes of equal content are one: copies of an object that the artist did not link are traced as if they were.
void InstanceTable::number_shapes_anew() {
    std::vector<std::shared_ptr<const Shape>> all;
    std::unordered_map<const Shape*, uint32_t> places;  // in `all`
    shape_of.clear();
    shape_of.reserve(instances.size());
    for (const TracedInstance& instance : instances) {
        const auto [entry, added] = places.try_emplace(instance.shape.get(), static_cast<uint32_t>(all.size()));
        if (added) all.push_back(instance.shape);
        shape_of.push_back(entry->second);
    }
    std::vector<TracedShapeKey> keys(all.size());
    tbb::parallel_for(size_t{0}, all.size(), [&](size_t i) { keys[i] = key_of(*all[i], {}); });
    unique.clear();
    std::map<TracedShapeKey, uint32_t> of_content;
    std::vector<uint32_t> numbers;
    for (size_t i = 0; i < all.size(); ++i) {
        const auto next = static_cast<uint32_t>(unique.size());
        numbers.push_back(of_content.try_emplace(keys[i], next).first->second);
        if (numbers.back() == next) unique.push_back(std::move(all[i]));
    }
    for (uint32_t& shape : shape_of) shape = numbers[shape];
}

/// Finds which shapes there are, and of which the tolerances are to be found: of those that have changed, or any of
/// whose instances has.
void InstanceTable::number_shapes(Changes& changes, bool same_view) {
    const std::vector<std::shared_ptr<const Shape>> before = std::move(unique);
    const std::vector<uint32_t> shape_before = std::move(shape_of);
    const auto has_shape_of_before = [&](uint32_t i) {
        return are_alike(*instances[i].shape, *before[shape_before[i]]);
    };
    if (shape_before.size() == instances.size() && std::ranges::all_of(changes.items, has_shape_of_before)) {
        unique = before;
        shape_of = shape_before;
    } else {
        number_shapes_anew();
    }
    const bool same_numbers = same_view && before.size() == unique.size() && shape_before == shape_of;
    changes.of_tolerances.assign(unique.size(), same_numbers ? 0 : 1);
    if (!same_numbers) return;
    for (size_t shape = 0; shape < unique.size(); ++shape)
        if (unique[shape] != before[shape]) changes.of_tolerances[shape] = 1;
    for (const uint32_t i : changes.items) changes.of_tolerances[shape_of[i]] = 1;
}

void InstanceTable::find_tolerances(const Changes& changes) {
    std::vector<ShapeTolerance> found = facet_tolerances(instances, shape_of, changes.of_tolerances, view_);
    tolerances.resize(unique.size());
    for (size_t shape = 0; shape < unique.size(); ++shape)
        if (changes.of_tolerances[shape] != 0) tolerances[shape] = std::move(found[shape]);
}

void InstanceTable::trace_shapes(Changes& changes, TracedShapeStore* store, const CancelToken& cancel) {
    std::vector<uint32_t> uses(unique.size());
    for (const uint32_t shape : shape_of) ++uses[shape];
    const std::vector<std::shared_ptr<ShapeScene>> before = std::move(shapes);
    TracedShapes traced =
        traced_shapes(unique, uses, tolerances, view_.coarsest_cached, resident_budget_, store, cancel);
    shapes = std::move(traced.all);
    kept_shapes = traced.kept;
    changes.of_shapes.assign(unique.size(), 1);
    for (size_t shape = 0; shape < std::min(before.size(), shapes.size()); ++shape)
        changes.of_shapes[shape] = shapes[shape] == before[shape] ? 0 : 1;
}

/// Sets what is new, or is traced as another shape than before; returns those.
std::vector<uint32_t> InstanceTable::place_instances(const Changes& changes) {
    std::vector<uint8_t> is_placed(instances.size());
    for (const uint32_t i : changes.items) is_placed[i] = 1;
    std::vector<uint32_t> placed;
    for (uint32_t i = 0; i < instances.size(); ++i)
        if (is_placed[i] != 0 || changes.of_shapes[shape_of[i]] != 0) placed.push_back(i);
    records.resize(instances.size());
    boxes.resize(instances.size());
    for (const uint32_t i : placed) moving -= records[i].motion ? 1 : 0;
    tbb::parallel_for(size_t{0}, placed.size(), [&](size_t k) {
        const uint32_t i = placed[k];
        InstanceRecord& record = records[i];
        record = {};
        record.scene = shapes[shape_of[i]].get();
        record.visibility = instances[i].visibility;
        record.place(*instances[i].shape, instances[i].object_to_world);
        record.motion = instances[i].motion.get();
        boxes[i] = record.world_box();
    });
    for (const uint32_t i : placed) moving += records[i].motion ? 1 : 0;
    return placed;
}

void InstanceTable::set_bounds() {
    bounds.makeEmpty();
    for (const Box3d& box : boxes) bounds.extendBy(box);
}

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

/// What moves has none: any ray meets it.
OrientedBox InstanceTable::oriented_in_tree(const TreeItem& item) const {
    const InstanceRecord& record = records[item.instance];
    const Box3d& box = item.part < 0 ? record.scene->box() : part_of(record, item.part).box;
    OrientedBox turned;
    if (record.motion || box.isEmpty()) return turned;
    const Vec3d center = record.point_to_local(frame.center);
    for (int i = 0; i < 3; ++i) {
        const Vec3d row = Vec3d(record.to_local_x[i], record.to_local_y[i], record.to_local_z[i]) * frame.scale;
        const double length = row.length();
        for (int axis = 0; axis < 3; ++axis) turned.axis[i][axis] = static_cast<float>(row[axis] / length);
        turned.low[i] = static_cast<float>((box.min[i] - center[i]) / length - 2.0 * kBoxPadding);
        turned.high[i] = static_cast<float>((box.max[i] - center[i]) / length + 2.0 * kBoxPadding);
    }
    return turned;
}

/// Of instances whose parts fill little of their boxes, like curves, the tree holds the parts: where such boxes
/// overlap, a ray meets what is near first, and few of the others. The largest instances are opened first, as rays meet
/// them most (C. Benthin, S. Woop, I. Wald, A. Áfra: Improved Two-Level BVHs using Partial Re-Braiding, HPG 2017).
std::vector<uint8_t> InstanceTable::choose_open() const {
    constexpr size_t kMostOpened = 512;
    std::vector<uint32_t> largest = all_items(instances.size());
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

void InstanceTable::set_items(std::span<const uint8_t> open) {
    first_item_.assign(1, 0);
    for (uint32_t i = 0; i < instances.size(); ++i)
        first_item_.push_back(first_item_.back() +
                              (open[i] != 0 ? static_cast<uint32_t>(records[i].scene->parts().size()) : 1));
    items.resize(first_item_.back());
    for (uint32_t i = 0; i < instances.size(); ++i) set_items_of(i);
}

/// As many as it had. False where that cannot be.
bool InstanceTable::set_items_of(uint32_t instance) {
    const std::span all =
        std::span(items).subspan(first_item_[instance], first_item_[instance + 1] - first_item_[instance]);
    if (!is_open(instance)) {
        all.front() = {instance};
        return true;
    }
    const InstanceRecord& record = records[instance];
    if (!may_be_open(record) || record.scene->parts().size() != all.size()) return false;
    for (size_t part = 0; part < all.size(); ++part)
        all[part] = {instance, record.scene->parts()[part].root, static_cast<int>(part)};
    return true;
}

size_t InstanceTable::opened() const {
    return tree.empty() ? 0
                        : static_cast<size_t>(std::ranges::count_if(all_items(instances.size()),
                                                                    [this](uint32_t i) { return is_open(i); }));
}

void InstanceTable::take_caches() {
    if (tree.empty()) return;
    const std::vector<uint8_t> open = choose_open();
    for (uint32_t i = 0; i < instances.size(); ++i)
        if (is_open(i) != (open[i] != 0)) return build_tree(open, kNeverCancelled);
}

void InstanceTable::renew_tree(std::span<const uint32_t> placed, const CancelToken& cancel) {
    const auto count = static_cast<uint32_t>(instances.size());
    moved_ += static_cast<uint32_t>(std::min<size_t>(placed.size(), count));
    if (!tree.empty() && moved_ <= count / kMovedShare && frame_holds() && refit_tree(placed)) return;
    frame = LocalFrame::fitting(bounds);
    moved_ = 0;
    tree = {};
    items.clear();
    oriented.clear();
    if (count > kDirectInstances && !bounds.isEmpty()) build_tree(choose_open(), cancel);
}

void InstanceTable::build_tree(std::span<const uint8_t> open, const CancelToken& cancel) {
    set_items(open);
    const auto count = static_cast<uint32_t>(items.size());
    tree = BoxTree(
        count, [this](uint32_t i) { return box_in_tree(items[i]); }, cancel);
    oriented.resize(count);
    tbb::parallel_for(0u, count, [&](uint32_t i) { oriented[i] = oriented_in_tree(items[i]); });
}

/// False where it must be built anew.
bool InstanceTable::refit_tree(std::span<const uint32_t> placed) {
    std::vector<uint32_t> moved;
    for (const uint32_t i : placed) {
        if (!set_items_of(i)) return false;
        for (uint32_t item = first_item_[i]; item < first_item_[i + 1]; ++item) moved.push_back(item);
    }
    if (!tree.refit(moved, [this](uint32_t i) { return box_in_tree(items[i]); })) return false;
    for (const uint32_t item : moved) oriented[item] = oriented_in_tree(items[item]);
    return true;
}

}  // namespace rayleaf
