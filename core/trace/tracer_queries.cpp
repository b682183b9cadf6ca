#include "trace/tracer_queries.h"

#include "trace/float_environment.h"

#include <limits>

namespace rayleaf {
namespace {

/// How far around its start a ray is told of the ray that found it, in longest lines of the subpatch that was hit: from
/// anywhere on it, the middles of the borders of another one of its size right behind it are nearer.
constexpr float kSightReach = 2.0f;

}  // namespace

std::optional<LocalRay> Tracer::Implementation::local_ray(const Query& query, uint32_t index,
                                                          const InstanceRecord& record) const {
    if ((record.visibility & query.kind) == 0 || record.scene->box().isEmpty()) return std::nullopt;
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
    std::optional<InstanceRecord> room;
    const InstanceRecord* record = records[index].at(query.ray->time, room);
    if (!record) return;
    const std::optional<LocalRay> ray = local_ray(query, index, *record);
    if (!ray) return;
    RayAnswer by = RayAnswer::NotAsked;
    if (record->cache && query.ray->leaves != index) {
        const ObjectAnswer answer = record->ask(*query.ray, *ray, query.differential);
        by = answer.answer;
        if (by != RayAnswer::Traced && (by == RayAnswer::Missed || !take_interpolated(query, index, *ray, answer))) {
            query.missed = query.missed == RayAnswer::Traced ? query.missed : RayAnswer::Missed;
            return;
        }
    }
    if (by == RayAnswer::NotAsked || by == RayAnswer::Traced) {
        std::optional<ShapeHit> nearer;
        ShapeHit& hit = query.found ? nearer.emplace() : query.best;
        const bool found = record->scene->closest(*ray, hit);
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
    std::optional<InstanceRecord> room;
    const InstanceRecord* record = records[index].at(query.ray->time, room);
    if (!record) return;
    const std::optional<LocalRay> ray = local_ray(query, index, *record);
    if (!ray) return;
    if (record->cache && query.ray->leaves != index) {
        const ObjectAnswer answer = record->ask(*query.ray, *ray, query.differential);
        if (answer.answer != RayAnswer::Traced) {
            query.found |= answer.answer != RayAnswer::Missed && take_interpolated(query, index, *ray, answer);
            return;
        }
    }
    if (record->scene->occluded(*ray)) query.found = true;
}

/// Prepares a query; false if the ray can hit nothing.
bool Tracer::Implementation::start(Query& query, const Ray& ray, Visibility kind) const {
    if (bounds.isEmpty() || !is_traceable(ray)) return false;
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

/// Asks all instances, one by one or through the tree above them.
void Tracer::Implementation::ask_all(Query& query, Wanted wanted) const {
    std::optional<GeometryCache::Reader> reader;
    if (cache) query.reader = &reader.emplace(*cache);
    if (!tree.empty()) return ask_above(query, wanted);
    for (uint32_t i = 0; i < instances.size() && !(wanted == Wanted::Any && query.found); ++i)
        visit_alone(query, i, wanted);
}

void Tracer::Implementation::ask_above(Query& query, Wanted wanted) const {
    const std::optional<LocalRay> ray = ray_above(*query.ray);
    if (!ray) return;
    struct Asked {
        const Implementation* tracer;
        Query* query;
        const LocalRay* ray;
        Wanted wanted;
    } asked{this, &query, &*ray, wanted};
    const auto visit_one = [](void* owner, uint32_t index, uint32_t, float* farthest) {
        const Asked& all = *static_cast<const Asked*>(owner);
        all.tracer->visit_alone(*all.query, index, all.wanted);
        if (all.query->found)
            *farthest = all.wanted == Wanted::Any ? kDone : all.ray->float_distance(all.query->farthest);
    };
    float farthest = ray->float_distance(ray->t_max);
    traversal.alone(tree.nodes(), ray->float_origin, ray->float_direction, &farthest, {visit_one, &asked});
}

void Tracer::Implementation::set_hit(Query& query, Hit& hit) const {
    hit.t = query.farthest;
    hit.instance = query.instance;
    hit.answer = query.answer;
    if (!hit.is_interpolated()) {
        hit.local = records[query.instance].scene->hit_at(query.best, shutter_time(query.ray->time));
        return;
    }
    std::optional<InstanceRecord> room;
    const InstanceRecord& record = *records[query.instance].at(query.ray->time, room);
    hit.interpolated = query.interpolated->hit;
    hit.local = record.interpolated_local(*query.ray, hit.t, *query.interpolated);
}

/// What a ray that starts at a hit knows about the ray that found it.
RaySight Tracer::Implementation::sight_from(const Ray& ray, const Hit& hit) const {
    RaySight sight =
        hit.local.seen_by == SeenBy::RayBefore ? ray.start.sight : RaySight{ray.origin, ray.direction, ray.beam, 0.0f};
    std::optional<InstanceRecord> room;
    sight.reach = kSightReach * hit.local.subpatch_length / records[hit.instance].at(ray.time, room)->shrink;
    return sight;
}

RayAnswer Tracer::Implementation::answer(Query& query, std::optional<Hit>& hit) const {
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
