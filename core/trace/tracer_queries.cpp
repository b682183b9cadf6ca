#include "trace/tracer_queries.h"

#include "trace/float_environment.h"

#include <limits>

namespace rayleaf {
namespace {

/// How far around its start a ray is told of the ray that found it, in longest lines of the subpatch that was hit: from
/// anywhere on it, the middles of the borders of another one of its size right behind it are nearer.
constexpr float kSightReach = 2.0f;

}  // namespace

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
    if (local) local->reader = query.reader;
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
    RTCRayN* ray = RTCRayHitN_RayN(arguments->rayhit, arguments->N);
    if (!is_alone(ray, arguments->N)) return packet_closest_callback(arguments);
    if (arguments->valid[0] == 0) return;
    Query& query = Query::of(arguments->context);
    query.tracer->visit_closest(query, arguments->primID);
    if (query.found) RTCRayN_tfar(ray, arguments->N, 0) = query.scene_ray->float_distance(query.farthest);
}

void Tracer::Implementation::any_callback(const RTCOccludedFunctionNArguments* arguments) {
    if (!is_alone(arguments->ray, arguments->N)) return packet_any_callback(arguments);
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
    std::optional<GeometryCache::Reader> reader;
    if (cache) query.reader = &reader.emplace(*cache);
    if (!scene) {
        for (uint32_t i = 0; i < instances.size() && !(wanted == Wanted::Any && query.found); ++i)
            visit_alone(query, i, wanted);
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

RayAnswer Tracer::Implementation::answer(const Query& query, std::optional<Hit>& hit) const {
    if (!query.found) return query.missed;
    set_hit(query, hit.emplace());
    return query.answer == RayAnswer::NotAsked ? query.missed : query.answer;
}

RayAnswer Tracer::Implementation::find(const Ray& ray, Visibility kind, const RayDifferential* differential,
                                       std::optional<Hit>& hit) const {
    const FloatEnvironment environment;
    Query query;
    query.differential = differential;
    if (!start(query, ray, kind)) return RayAnswer::NotAsked;
    ask_all(query, Wanted::Closest);
    return answer(query, hit);
}

}  // namespace rayleaf
