#include "base/error.h"
#include "tessellation/grid_arena.h"
#include "trace/dicing.h"
#include "trace/float_environment.h"
#include "trace/make_scene.h"
#include "trace/tracer_queries.h"

#include <atomic>
#include <unordered_map>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

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
                           std::span<const ShapeTolerance> tolerances, uint64_t resident_budget,
                           TracedShapeStore* store, const CancelToken& cancel) {
    const size_t count = unique.size();
    std::vector<TracedShapeKey> keys(count);
    std::vector<KeptShape> kept(count);
    std::vector<std::optional<ShapePlan>> plans(count);
    std::vector<uint64_t> bytes(count);
    if (store) store->next_user();
    const auto plan = [&](size_t i) { plans[i] = plan_shape(*unique[i], tolerances[i].tolerance, cancel); };
    tbb::parallel_for(size_t{0}, count, [&](size_t i) {
        if (store) {
            keys[i] = key_of(*unique[i], tolerances[i].key);
            kept[i] = store->find(keys[i]);
        }
        if (!kept[i].scene) plan(i);
        bytes[i] = plans[i] ? plans[i]->resident_bytes() : kept[i].resident_bytes;
    });
    const std::vector<Residence> residence = choose_residents(bytes, uses, resident_budget);
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
        if (!plans[i]) plan(i);
        const auto made = std::make_shared<OwnShapeScene>();
        made->shape = unique[i];
        made->scene = make_scene(std::move(*plans[i]), residence[i], cancel);
        shapes[i] = {made, made->scene.get()};
        if (store && lasts) store->keep(keys[i], {shapes[i], bytes[i]});
    });
    return {std::move(shapes), found};
}

/// Up to so many instances are asked one after the other, without a tree above them.
constexpr size_t kDirectInstances = 3;

}  // namespace

void Tracer::Implementation::build_shapes(const DicingView& view, uint64_t resident_budget, TracedShapeStore* store,
                                          const CancelToken& cancel) {
    std::unordered_map<const Shape*, size_t> numbers;
    std::vector<std::shared_ptr<const Shape>> unique;
    std::vector<size_t> shape_of;
    shape_of.reserve(instances.size());
    for (const TracedInstance& instance : instances) {
        const auto [entry, added] = numbers.try_emplace(instance.shape.get(), unique.size());
        if (added) unique.push_back(instance.shape);
        shape_of.push_back(entry->second);
    }
    const std::vector<ShapeTolerance> tolerances = facet_tolerances(instances, unique.size(), shape_of, view);
    std::vector<uint32_t> uses(unique.size());
    for (const size_t shape : shape_of) ++uses[shape];
    TracedShapes traced = traced_shapes(unique, uses, tolerances, resident_budget, store, cancel);
    shapes = std::move(traced.all);
    kept_shapes = traced.kept;
    records.resize(instances.size());
    for (size_t i = 0; i < instances.size(); ++i) records[i].scene = shapes[shape_of[i]].get();
}

void Tracer::Implementation::build_records() {
    for (size_t i = 0; i < instances.size(); ++i) {
        InstanceRecord& record = records[i];
        record.place(*instances[i].shape, instances[i].object_to_world);
        if (instances[i].motion) set_motion(static_cast<uint32_t>(i));
        bounds.extendBy(world_box(static_cast<uint32_t>(i)));
    }
    frame = LocalFrame::fitting(bounds);
}

void Tracer::Implementation::set_motion(uint32_t index) {
    records[index].motion = instances[index].motion.get();
    moving_boxes.resize(instances.size());
    moving_boxes[index] = records[index].world_box();
}

void Tracer::Implementation::build_tree(const CancelToken& cancel) {
    if (instances.size() <= kDirectInstances || bounds.isEmpty()) return;
    tree = BoxTree(
        static_cast<uint32_t>(instances.size()), [this](uint32_t i) { return box_in_tree(i); }, cancel);
}

void Tracer::Implementation::build_cache(const GeometryCacheSettings& settings) {
    uint64_t subpatches = 0;
    for (const std::shared_ptr<ShapeScene>& shape : shapes) subpatches += shape->cached_subpatches();
    if (subpatches >= GridArena::kMostSubpatches)
        throw InputError("scene", "subpatches", std::to_string(subpatches),
                         "fewer than " + std::to_string(GridArena::kMostSubpatches));
    if (subpatches == 0) return;
    cache = std::make_unique<GeometryCache>(settings, static_cast<uint32_t>(subpatches));
    uint32_t first = 0;
    for (const std::shared_ptr<ShapeScene>& shape : shapes) {
        if (shape->cached_subpatches() == 0) continue;  // it may be another tracer's too
        shape->set_geometry_cache(*cache, first);
        first += shape->cached_subpatches();
    }
}

Tracer::Tracer(std::vector<TracedInstance> instances, const DicingView& view, const CancelToken& cancel,
               const GeometryCacheSettings& cache, TracedShapeStore* kept)
    : implementation_(std::make_unique<Implementation>()) {
    const uint64_t before = embree_bytes();
    implementation_->instances = std::move(instances);
    implementation_->build_shapes(view, cache.resident_budget, kept, cancel);
    implementation_->build_records();
    implementation_->build_tree(cancel);
    implementation_->build_cache(cache);
    implementation_->embree_held = embree_bytes() - std::min(before, embree_bytes());
}

Tracer::~Tracer() = default;

std::optional<Hit> Tracer::closest_hit(const Ray& ray, Visibility kind) const {
    std::optional<Hit> hit;
    implementation_->find(ray, kind, nullptr, hit);
    return hit;
}

ClosestHit Tracer::closest(const Ray& ray, Visibility kind, const RayDifferential* differential) const {
    ClosestHit result;
    result.answer = implementation_->find(ray, kind, differential, result.hit);
    return result;
}

std::optional<Hit> Tracer::closest_on(uint32_t instance, const Ray& ray) const {
    const FloatEnvironment environment;
    std::optional<InstanceRecord> room;
    const InstanceRecord* record = implementation_->records[instance].at(ray.time, room);
    return record && is_traceable(ray) ? record->closest(instance, ray) : std::nullopt;
}

LengthAnswer Tracer::length_inside(uint32_t instance, const Ray& ray) const {
    const FloatEnvironment environment;
    std::optional<InstanceRecord> room;
    const InstanceRecord* record = implementation_->records[instance].at(ray.time, room);
    return record && is_traceable(ray) ? record->length_inside(ray) : LengthAnswer{RayAnswer::NotAsked};
}

bool Tracer::occluded(const Ray& ray, Visibility kind) const {
    const FloatEnvironment environment;
    Implementation::Query query;
    if (!implementation_->start(query, ray, kind)) return false;
    implementation_->ask_all(query, Implementation::Wanted::Any);
    return query.found;
}

SurfacePoint Tracer::surface_point(const Ray& ray, const Hit& hit, SurfaceDetail detail) const {
    const double size = max_abs(ray.origin) + hit.t * max_abs(ray.direction);
    std::optional<InstanceRecord> room;
    SurfacePoint point =
        implementation_->records[hit.instance]
            .at(ray.time, room)
            ->surface_point(hit.instance, hit.local, size, hit.is_interpolated() ? &hit.interpolated : nullptr, detail);
    point.t = hit.t;
    point.time = ray.time;
    if (hit.local.subpatch_length > 0.0f) point.sight = implementation_->sight_from(ray, hit);
    return point;
}

/// Where it is at rest while it is flat.
const InstanceRecord& Tracer::Implementation::record_at(uint32_t instance, float time,
                                                        std::optional<InstanceRecord>& room) const {
    const InstanceRecord* moved = records[instance].at(time, room);
    return moved ? *moved : records[instance];
}

SurfacePoint Tracer::surface_point(uint32_t instance, const LocalHit& hit, float time) const {
    std::optional<InstanceRecord> room;
    const InstanceRecord& record = implementation_->record_at(instance, time, room);
    LocalHit now = hit;
    now.time = shutter_time(time);
    SurfacePoint point =
        record.surface_point(instance, record.scene->on_facet(now), 0.0, nullptr, SurfaceDetail::Curvature);
    point.time = time;
    return point;
}

SurfacePoint Tracer::place(uint32_t instance, const LocalHit& hit, float time) const {
    std::optional<InstanceRecord> room;
    const InstanceRecord& record = implementation_->record_at(instance, time, room);
    SurfacePoint point = record.facet_point(instance, record.scene->on_facet(hit), 0.0);
    point.position = record.local_to_world.point(hit.position);
    point.time = time;
    return point;
}

void Tracer::set_cache(uint32_t instance, std::shared_ptr<const LocalRayCache> cache) {
    implementation_->records[instance].cache = cache.get();
    implementation_->caches.resize(implementation_->instances.size());
    implementation_->caches[instance] = std::move(cache);
}

const LocalRayCache* Tracer::cache(uint32_t instance) const {
    return implementation_->records[instance].cache;
}

bool Tracer::has_levels() const {
    return implementation_->cache != nullptr;
}

const TracedInstance& Tracer::instance(uint32_t index) const {
    return implementation_->instances[index];
}

Affine3d Tracer::local_to_world(uint32_t index, float time) const {
    const InstanceRecord& record = implementation_->records[index];
    return record.motion ? record.motion->at(time) * record.scene->shape().frame().to_object() : record.local_to_world;
}

bool Tracer::has_motion() const {
    const auto deforms = [](const std::shared_ptr<ShapeScene>& shape) { return shape->deforms(); };
    return !implementation_->moving_boxes.empty() || std::ranges::any_of(implementation_->shapes, deforms);
}

Box3d Tracer::bounds() const {
    return implementation_->bounds;
}

Box3d Tracer::bounds(uint32_t instance) const {
    return implementation_->world_box(instance);
}

TraceStatistics Tracer::statistics() const {
    TraceStatistics result;
    result.instances = implementation_->instances.size();
    result.shapes = implementation_->shapes.size();
    result.kept_shapes = implementation_->kept_shapes;
    result.bvh_bytes = implementation_->embree_held + implementation_->tree.bytes();
    for (const std::shared_ptr<ShapeScene>& shape : implementation_->shapes) {
        result.subpatches += shape->subpatch_count();
        result.record_bytes += shape->record_bytes();
        result.facet_bytes += shape->facet_bytes();
        result.bvh_bytes += shape->tree_bytes();
        result.resident_shapes += shape->facet_bytes() > 0 ? 1 : 0;
        result.triangles += shape->triangle_count();
        result.limit_normals += shape->limit_normals();
    }
    if (implementation_->cache) result.geometry = implementation_->cache->statistics();
    return result;
}

uint64_t Tracer::thread_misses() const {
    return implementation_->cache ? GeometryCache::Reader(*implementation_->cache).misses() : 0;
}

}  // namespace rayleaf
