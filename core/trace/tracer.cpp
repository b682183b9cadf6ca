#include "base/error.h"
#include "tessellation/grid_arena.h"
#include "trace/float_environment.h"
#include "trace/tracer_queries.h"

namespace rayleaf {
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

Tracer::Tracer(ChunkedVector<TracedInstance> instances, const DicingView& view, const CancelToken& cancel,
               const GeometryCacheSettings& cache, TracedShapeStore* kept)
    : implementation_(std::make_unique<Implementation>()) {
    const uint64_t before = embree_bytes();
    InstanceTable& table = *implementation_;
    if (kept) {
        const auto likeness = [&](const InstanceTable& spare) { return spare.likeness(instances); };
        if (std::optional<InstanceTable> spare = kept->tables.take(likeness)) table = std::move(*spare);
    }
    table.update(std::move(instances), view, cache.resident_budget, kept, cancel);
    implementation_->build_cache(cache);
    has_levels_ = implementation_->cache != nullptr;
    implementation_->embree_held = embree_bytes() - std::min(before, embree_bytes());
    implementation_->store = kept;
}

Tracer::~Tracer() {
    if (implementation_->store) implementation_->give_back_table();
}

void Tracer::Implementation::give_back_table() {
    std::vector<uint32_t> had_caches;
    for (uint32_t i = 0; i < caches.size(); ++i) {
        if (!caches[i]) continue;
        records[i].cache = nullptr;
        had_caches.push_back(i);
    }
    if (!had_caches.empty()) take_caches(had_caches);
    store->tables.give_back(std::move(static_cast<InstanceTable&>(*this)));
}

Maybe<Hit> Tracer::closest_hit(const Ray& ray, Visibility kind) const {
    return implementation_->closest({&ray, kind, nullptr}).hit;
}

ClosestHit Tracer::closest(const Ray& ray, Visibility kind, const RayDifferential* differential) const {
    return implementation_->closest({&ray, kind, differential});
}

Maybe<Hit> Tracer::closest_on(uint32_t instance, const Ray& ray) const {
    const FloatEnvironment environment;
    Maybe<InstanceRecord> room;
    const InstanceRecord* record = implementation_->records[instance].at(ray.time, room);
    return record && is_traceable(ray) ? record->closest(instance, ray) : std::nullopt;
}

LengthAnswer Tracer::length_inside(uint32_t instance, const Ray& ray) const {
    const FloatEnvironment environment;
    Maybe<InstanceRecord> room;
    const InstanceRecord* record = implementation_->records[instance].at(ray.time, room);
    return record && is_traceable(ray) ? record->length_inside(ray) : LengthAnswer{RayAnswer::NotAsked};
}

bool Tracer::occluded(const Ray& ray, Visibility kind) const {
    const FloatEnvironment environment;
    if (!implementation_->can_hit(ray)) return false;
    Implementation::Query query{{&ray, kind, nullptr}, nullptr, ray.t_max, 0, nullptr, nullptr};
    return implementation_->ask_all(query);
}

SurfacePoint Tracer::surface_point(const Ray& ray, const Hit& hit, SurfaceDetail detail) const {
    const double size = max_abs(ray.origin) + hit.t * max_abs(ray.direction);
    Maybe<InstanceRecord> room;
    SurfacePoint point =
        implementation_->records[hit.instance]
            .at(ray.time, room)
            ->surface_point(hit.instance, hit.local, size, hit.interpolated ? &*hit.interpolated : nullptr, detail);
    point.t = hit.t;
    point.time = ray.time;
    if (hit.local.subpatch_length > 0.0f) point.sight = implementation_->sight_from(ray, hit);
    return point;
}

/// Where it is at rest while it is flat.
const InstanceRecord& Tracer::Implementation::record_at(uint32_t instance, float time,
                                                        Maybe<InstanceRecord>& room) const {
    const InstanceRecord* moved = records[instance].at(time, room);
    return moved ? *moved : records[instance];
}

SurfacePoint Tracer::surface_point(uint32_t instance, const LocalHit& hit, float time) const {
    Maybe<InstanceRecord> room;
    const InstanceRecord& record = implementation_->record_at(instance, time, room);
    LocalHit now = hit;
    now.time = shutter_time(time);
    SurfacePoint point =
        record.surface_point(instance, record.scene->on_facet(now), 0.0, nullptr, SurfaceDetail::Curvature);
    point.time = time;
    return point;
}

SurfacePoint Tracer::place(uint32_t instance, const LocalHit& hit, float time) const {
    Maybe<InstanceRecord> room;
    const InstanceRecord& record = implementation_->record_at(instance, time, room);
    const ShapeScene& scene = *record.scene;
    const bool asks_facet = scene.has_levels() || !(scene.facet_distance() > 0.0);
    SurfacePoint point = record.facet_point(instance, asks_facet ? scene.on_facet(hit) : hit, 0.0);
    // Beside the surface as far as any facet may lie, the facet need not be found.
    if (!asks_facet) point.start_offset = point.facet_error + scene.facet_distance() * record.longest;
    point.position = record.local_to_world.point(hit.position);
    point.time = time;
    return point;
}

void Tracer::set_cache(std::span<const uint32_t> instances, const std::shared_ptr<const LocalRayCache>& cache) {
    implementation_->caches.resize(implementation_->instances.size());
    for (const uint32_t instance : instances) {
        implementation_->records[instance].cache = cache.get();
        implementation_->caches[instance] = cache;
    }
    implementation_->take_caches(instances);
}

void Tracer::set_passages(std::vector<LightPassage> passages) {
    implementation_->passages = std::move(passages);
}

bool Tracer::finds_passages() const {
    const std::vector<LightPassage>& passages = implementation_->passages;
    for (size_t i = 0; i < passages.size(); ++i)
        if (passages[i] == LightPassage::Surface && implementation_->records[i].scene->finds_all()) return true;
    return false;
}

Hit Tracer::hit_of(const Ray& ray, const PassedHit& passed) const {
    Hit hit(passed.point.t, passed.instance, RayAnswer::NotAsked);
    ShapeHit found;
    found.facet = {passed.primitive, passed.part};
    found.point = passed.point;
    hit.local = implementation_->records[passed.instance].scene->hit_at(found, shutter_time(ray.time));
    return hit;
}

bool Tracer::goes_through_geometry_cache(uint32_t instance) const {
    return implementation_->records[instance].scene->has_levels();
}

const LocalRayCache* Tracer::cache(uint32_t instance) const {
    return implementation_->records[instance].cache;
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
    return implementation_->moving > 0 || std::ranges::any_of(implementation_->shapes, deforms);
}

Box3d Tracer::bounds() const {
    return implementation_->bounds;
}

Box3d Tracer::bounds(uint32_t instance) const {
    return implementation_->boxes[instance];
}

TraceStatistics Tracer::statistics() const {
    TraceStatistics result;
    result.instances = implementation_->instances.size();
    result.shapes = implementation_->shapes.size();
    result.opened_instances = implementation_->opened();
    result.kept_shapes = implementation_->kept_shapes;
    result.bvh_bytes = implementation_->embree_held + implementation_->tree.bytes() +
                       implementation_->leaves.size() * sizeof(OrientedBoxes) +
                       implementation_->items.size() * sizeof(TreeItem);
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
