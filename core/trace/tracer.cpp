#include "trace/tracer.h"

#include "base/error.h"
#include "tessellation/grid_arena.h"
#include "trace/dicing.h"
#include "trace/embree.h"
#include "trace/float_environment.h"
#include "trace/instance_record.h"
#include "trace/local_ray.h"
#include "trace/make_scene.h"
#include "trace/shape_scene.h"

#include <array>
#include <unordered_map>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// Up to so many instances are asked one after the other, without an Embree scene above them.
constexpr size_t kDirectInstances = 3;

/// How far around its start a ray is told of the ray that found it, in longest lines of the subpatch that was hit: from
/// anywhere on it, the middles of the borders of another one of its size right behind it are nearer.
constexpr float kSightReach = 2.0f;

}  // namespace

struct Tracer::Implementation {
    std::vector<TracedInstance> instances;
    std::vector<InstanceRecord> records;
    std::vector<std::unique_ptr<ShapeScene>> shapes;
    Box3d bounds;
    LocalFrame frame;  ///< world -> the space of the scene above the instances
    EmbreeScene scene;
    std::unique_ptr<GeometryCache> cache;  ///< null without patches
    uint64_t bvh_bytes = 0;  ///< what Embree held more after the build; tracers built at the same time blur it

    struct Query {
        EmbreeContext context;
        const Implementation* tracer = nullptr;
        std::optional<GeometryCache::Reader> reader;
        const Ray* ray = nullptr;
        const RayDifferential* differential = nullptr;  ///< of `ray`; null: nobody wants to know how hits change
        Visibility kind = kVisibleAll;
        std::optional<LocalRay> scene_ray;  ///< in the space above the instances, where there is a scene of them
        ShapeHit best;
        uint32_t instance = 0;
        double farthest = 0;  ///< world t of the best hit, or the ray's t_max
        bool found = false;
        std::optional<ObjectAnswer> interpolated;  ///< the best hit, where it is no facet's
        /// How the objects that were asked answered: that of the best hit, and of those that were missed.
        RayAnswer answer = RayAnswer::NotAsked, missed = RayAnswer::NotAsked;

        static Query& of(EmbreeContext* embree_context) { return *reinterpret_cast<Query*>(embree_context); }
    };

    void build_shapes(const DicingView& view, const CancelToken& cancel);
    void build_records();
    void build_scene(const CancelToken& cancel);
    void build_cache(const GeometryCacheSettings& settings);
    Box3d world_box(uint32_t index) const { return records[index].world_box(); }

    std::optional<LocalRay> local_ray(const Query& query, uint32_t index) const;
    /// The nearest hit, and how objects with caches answered.
    RayAnswer find(const Ray& ray, Visibility kind, const RayDifferential* differential, std::optional<Hit>& hit) const;
    void visit_closest(Query& query, uint32_t index) const;
    bool take_interpolated(Query& query, uint32_t index, const LocalRay& ray, const ObjectAnswer& answer) const;
    void visit_any(Query& query, uint32_t index) const;
    bool start(Query& query, const Ray& ray, Visibility kind) const;
    std::optional<LocalRay> ray_above(const Ray& ray) const;
    enum class Wanted : uint8_t { Closest, Any };
    void ask_all(Query& query, Wanted wanted) const;
    void set_hit(const Query& query, Hit& hit) const;
    RaySight sight_from(const Ray& ray, const Hit& hit) const;

    static void bounds_callback(const RTCBoundsFunctionArguments* arguments);
    static void closest_callback(const RTCIntersectFunctionNArguments* arguments);
    static void any_callback(const RTCOccludedFunctionNArguments* arguments);
};

void Tracer::Implementation::build_shapes(const DicingView& view, const CancelToken& cancel) {
    std::unordered_map<const Shape*, size_t> numbers;
    std::vector<const Shape*> unique;
    std::vector<size_t> shape_of;
    shape_of.reserve(instances.size());
    for (const TracedInstance& instance : instances) {
        const auto [entry, added] = numbers.try_emplace(instance.shape.get(), unique.size());
        if (added) unique.push_back(instance.shape.get());
        shape_of.push_back(entry->second);
    }
    const std::vector<FacetTolerance> tolerances = facet_tolerances(instances, unique.size(), shape_of, view);
    shapes.resize(unique.size());
    tbb::parallel_for(size_t{0}, unique.size(),
                      [&](size_t i) { shapes[i] = make_scene(*unique[i], tolerances[i], cancel); });
    records.resize(instances.size());
    for (size_t i = 0; i < instances.size(); ++i) records[i].scene = shapes[shape_of[i]].get();
}

void Tracer::Implementation::build_records() {
    for (size_t i = 0; i < instances.size(); ++i) {
        InstanceRecord& record = records[i];
        record.place(*instances[i].shape, instances[i].object_to_world);
        bounds.extendBy(world_box(static_cast<uint32_t>(i)));
    }
    frame = LocalFrame::fitting(bounds);
}

void Tracer::Implementation::build_scene(const CancelToken& cancel) {
    if (instances.size() <= kDirectInstances || bounds.isEmpty()) return;
    scene = new_embree_scene(cancel);
    build_embree_scene(scene,
                       new_user_geometry(this, instances.size(), {bounds_callback, closest_callback, any_callback}));
}

void Tracer::Implementation::build_cache(const GeometryCacheSettings& settings) {
    uint64_t subpatches = 0;
    for (const std::unique_ptr<ShapeScene>& shape : shapes) subpatches += shape->subpatch_count();
    if (subpatches >= GridArena::kMostSubpatches)
        throw InputError("scene", "subpatches", std::to_string(subpatches),
                         "fewer than " + std::to_string(GridArena::kMostSubpatches));
    if (subpatches == 0) return;
    cache = std::make_unique<GeometryCache>(settings, static_cast<uint32_t>(subpatches));
    uint32_t first = 0;
    for (const std::unique_ptr<ShapeScene>& shape : shapes) {
        shape->set_geometry_cache(*cache, first);
        first += shape->subpatch_count();
    }
}

void Tracer::Implementation::bounds_callback(const RTCBoundsFunctionArguments* arguments) {
    const auto& self = *static_cast<const Implementation*>(arguments->geometryUserPtr);
    const Box3d box = self.world_box(arguments->primID);
    RTCBounds& out = *arguments->bounds_o;
    if (box.isEmpty()) {  // Embree leaves out primitives whose bounds are reversed.
        out = {1.0f, 1.0f, 1.0f, 0.0f, -1.0f, -1.0f, -1.0f, 0.0f};
        return;
    }
    constexpr auto kPadding = static_cast<float>(kBoxPadding);
    const Vec3f low = self.frame.to_local(box.min) - Vec3f(kPadding),
                high = self.frame.to_local(box.max) + Vec3f(kPadding);
    out = {low.x, low.y, low.z, 0.0f, high.x, high.y, high.z, 0.0f};
}

std::optional<LocalRay> Tracer::Implementation::local_ray(const Query& query, uint32_t index) const {
    const InstanceRecord& record = records[index];
    if ((instances[index].visibility & query.kind) == 0 || record.scene->box().isEmpty()) return std::nullopt;
    std::optional<LocalRay> local = record.local_ray(index, *query.ray, query.farthest);
    if (local && query.reader) local->reader = &*query.reader;
    return local;
}

bool Tracer::Implementation::take_interpolated(Query& query, uint32_t index, const LocalRay& ray,
                                               const ObjectAnswer& answer) const {
    // Within the box, whatever the error: then it cannot matter which objects were visited before.
    const double t = std::max(query.ray->t_min + answer.distance / ray.speed, ray.start);
    if (!(t >= query.ray->t_min && t <= query.farthest)) return false;
    if (query.found && t == query.farthest && query.instance < index) return false;
    query.interpolated = answer;
    query.farthest = t;
    return true;
}

void Tracer::Implementation::visit_closest(Query& query, uint32_t index) const {
    const std::optional<LocalRay> ray = local_ray(query, index);
    if (!ray) return;
    RayAnswer by = RayAnswer::NotAsked;
    if (records[index].cache && query.ray->leaves != index) {
        const ObjectAnswer answer = records[index].ask(*query.ray, *ray, query.differential);
        by = answer.answer;
        if (by != RayAnswer::Traced && (by == RayAnswer::Missed || !take_interpolated(query, index, *ray, answer))) {
            query.missed = query.missed == RayAnswer::Traced ? query.missed : RayAnswer::Missed;
            return;
        }
    }
    if (by == RayAnswer::NotAsked || by == RayAnswer::Traced) {
        std::optional<ShapeHit> nearer;
        ShapeHit& hit = query.found ? nearer.emplace() : query.best;
        const bool found = records[index].scene->closest(*ray, hit);
        if (!found || (query.found && hit.point.t == query.farthest && query.instance < index)) {
            if (by == RayAnswer::Traced) query.missed = by;
            return;
        }
        if (nearer) query.best = *nearer;
        query.farthest = hit.point.t;
    }
    query.answer = by;
    query.instance = index;
    query.found = true;
}

void Tracer::Implementation::visit_any(Query& query, uint32_t index) const {
    const std::optional<LocalRay> ray = local_ray(query, index);
    if (!ray) return;
    if (records[index].cache && query.ray->leaves != index) {
        const ObjectAnswer answer = records[index].ask(*query.ray, *ray, query.differential);
        if (answer.answer != RayAnswer::Traced) {
            query.found |= answer.answer != RayAnswer::Missed && take_interpolated(query, index, *ray, answer);
            return;
        }
    }
    if (records[index].scene->occluded(*ray)) query.found = true;
}

void Tracer::Implementation::closest_callback(const RTCIntersectFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) return;
    Query& query = Query::of(arguments->context);
    query.tracer->visit_closest(query, arguments->primID);
    RTCRayN* ray = RTCRayHitN_RayN(arguments->rayhit, arguments->N);
    if (query.found) RTCRayN_tfar(ray, arguments->N, 0) = query.scene_ray->float_distance(query.farthest);
}

void Tracer::Implementation::any_callback(const RTCOccludedFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) return;
    Query& query = Query::of(arguments->context);
    query.tracer->visit_any(query, arguments->primID);
    if (query.found) RTCRayN_tfar(arguments->ray, arguments->N, 0) = -std::numeric_limits<float>::infinity();
}

/// Prepares a query; false if the ray can hit nothing.
bool Tracer::Implementation::start(Query& query, const Ray& ray, Visibility kind) const {
    if (bounds.isEmpty() || !is_traceable(ray)) return false;
    initialize(query.context);
    query.tracer = this;
    query.ray = &ray;
    query.kind = kind;
    query.farthest = ray.t_max;
    return true;
}

std::optional<LocalRay> Tracer::Implementation::ray_above(const Ray& ray) const {
    const Box3d box((bounds.min - frame.center) / frame.scale, (bounds.max - frame.center) / frame.scale);
    return clipped_ray(box, (ray.origin - frame.center) / frame.scale, ray.direction / frame.scale, ray.t_min,
                       ray.t_max);
}

/// Asks all instances, one by one or through the scene above them.
void Tracer::Implementation::ask_all(Query& query, Wanted wanted) const {
    if (cache) query.reader.emplace(*cache);
    if (!scene) {
        for (uint32_t i = 0; i < instances.size() && !(wanted == Wanted::Any && query.found); ++i)
            wanted == Wanted::Any ? visit_any(query, i) : visit_closest(query, i);
        return;
    }
    query.scene_ray = ray_above(*query.ray);
    if (!query.scene_ray) return;
    if (wanted == Wanted::Any) {
        RTCRay embree_ray = query.scene_ray->embree_ray();
        embree_any(scene.get(), query.context, embree_ray);
    } else {
        RTCRayHit embree_ray = query.scene_ray->embree_ray_hit();
        embree_closest(scene.get(), query.context, embree_ray);
    }
}

Tracer::Tracer(std::vector<TracedInstance> instances, const DicingView& view, const CancelToken& cancel,
               const GeometryCacheSettings& cache)
    : implementation_(std::make_unique<Implementation>()) {
    const uint64_t before = embree_bytes();
    implementation_->instances = std::move(instances);
    implementation_->build_shapes(view, cancel);
    implementation_->build_records();
    implementation_->build_scene(cancel);
    implementation_->build_cache(cache);
    implementation_->bvh_bytes = embree_bytes() - std::min(before, embree_bytes());
}

Tracer::~Tracer() = default;

void Tracer::Implementation::set_hit(const Query& query, Hit& hit) const {
    const InstanceRecord& record = records[query.instance];
    hit.t = query.farthest;
    hit.instance = query.instance;
    hit.answer = query.answer;
    if (!hit.is_interpolated()) {
        hit.local = record.scene->local_hit(query.best);
        return;
    }
    hit.interpolated = query.interpolated->hit;
    hit.local = record.interpolated_local(*query.ray, hit.t, *query.interpolated);
}

/// What a ray that starts at a hit is told of the ray that found it.
RaySight Tracer::Implementation::sight_from(const Ray& ray, const Hit& hit) const {
    RaySight sight =
        hit.local.seen_by == SeenBy::RayBefore ? ray.start.sight : RaySight{ray.origin, ray.direction, ray.beam, 0.0f};
    sight.reach = kSightReach * hit.local.subpatch_length / records[hit.instance].shrink;
    return sight;
}

RayAnswer Tracer::Implementation::find(const Ray& ray, Visibility kind, const RayDifferential* differential,
                                       std::optional<Hit>& hit) const {
    const FloatEnvironment environment;
    Query query;
    query.differential = differential;
    if (!start(query, ray, kind)) return RayAnswer::NotAsked;
    ask_all(query, Wanted::Closest);
    if (!query.found) return query.missed;
    set_hit(query, hit.emplace());
    return query.answer == RayAnswer::NotAsked ? query.missed : query.answer;
}

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
    return is_traceable(ray) ? implementation_->records[instance].closest(instance, ray) : std::nullopt;
}

LengthAnswer Tracer::length_inside(uint32_t instance, const Ray& ray) const {
    const FloatEnvironment environment;
    return is_traceable(ray) ? implementation_->records[instance].length_inside(ray)
                             : LengthAnswer{RayAnswer::NotAsked};
}

bool Tracer::occluded(const Ray& ray, Visibility kind) const {
    const FloatEnvironment environment;
    Implementation::Query query;
    if (!implementation_->start(query, ray, kind)) return false;
    implementation_->ask_all(query, Implementation::Wanted::Any);
    return query.found;
}

SurfacePoint Tracer::surface_point(const Ray& ray, const Hit& hit) const {
    const double size = max_abs(ray.origin) + hit.t * max_abs(ray.direction);
    SurfacePoint point = implementation_->records[hit.instance].surface_point(
        hit.instance, hit.local, size, hit.is_interpolated() ? &hit.interpolated : nullptr);
    point.t = hit.t;
    if (hit.local.subpatch_length > 0.0f) point.sight = implementation_->sight_from(ray, hit);
    return point;
}

SurfacePoint Tracer::surface_point(uint32_t instance, const LocalHit& hit) const {
    const InstanceRecord& record = implementation_->records[instance];
    return record.surface_point(instance, record.scene->on_facet(hit), 0.0, nullptr);
}

void Tracer::set_cache(uint32_t instance, std::shared_ptr<const ObjectCache> cache) {
    implementation_->records[instance].cache = std::move(cache);
}

const ObjectCache* Tracer::cache(uint32_t instance) const {
    return implementation_->records[instance].cache.get();
}

const TracedInstance& Tracer::instance(uint32_t index) const {
    return implementation_->instances[index];
}

const Affine3d& Tracer::local_to_world(uint32_t index) const {
    return implementation_->records[index].local_to_world;
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
    result.bvh_bytes = implementation_->bvh_bytes;
    for (const std::unique_ptr<ShapeScene>& shape : implementation_->shapes) {
        result.subpatches += shape->subpatch_count();
        result.record_bytes += shape->record_bytes();
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
