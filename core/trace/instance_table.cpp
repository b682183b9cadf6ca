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

}  // namespace rayleaf
