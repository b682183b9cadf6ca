#include "trace/tracer_queries.h"

#include "trace/float_environment.h"

#include <limits>
#include <new>

namespace rayleaf {
namespace {

/// How far around its start a ray is told of the ray that found it, in longest lines of the subpatch that was hit: from
/// anywhere on it, the middles of the borders of another one of its size right behind it are nearer.
constexpr float kSightReach = 2.0f;

/// Where an interpolated hit counts: within the box, whatever the error. Then it cannot matter which objects were
/// visited before.
double distance_to(const ObjectAnswer& answer, const Ray& world_ray, const LocalRay& ray) {
    return std::max(world_ray.t_min + answer.distance / ray.speed, ray.start);
}

}  // namespace

Maybe<LocalRay> Tracer::Implementation::local_ray(const Query& query, uint32_t index,
                                                  const InstanceRecord& record) const {
    Maybe<LocalRay> local = record.local_ray(index, *query.ray, query.farthest);
    if (!local) return local;
    local->reader = query.reader;
    local->root = query.root;
    return local;
}

bool Tracer::Implementation::visit_closest(Query& query, uint32_t index) const {
    Maybe<InstanceRecord> room;
    const InstanceRecord* record = records[index].at(query.ray->time, room);
    if (!record) return false;
    const Maybe<LocalRay> ray = local_ray(query, index, *record);
    if (!ray) return false;
    ClosestHit& result = *query.result;
    const auto take = [&](double t, RayAnswer by, const FacetId& facet) -> Hit* {
        if (result.hit && t == query.farthest && !goes_first(index, facet, result, *query.traced)) return nullptr;
        query.farthest = t;
        return &result.hit.emplace(t, index, by);
    };
    RayAnswer by = RayAnswer::NotAsked;
    if (record->cache && query.ray->leaves != index) {
        const ObjectAnswer answer = record->ask(*query.ray, *ray, query.differential);
        by = answer.answer;
        if (by != RayAnswer::Traced) {
            const double t = distance_to(answer, *query.ray, *ray);
            const bool meets = by != RayAnswer::Missed && t >= query.ray->t_min && t <= query.farthest;
            Hit* hit = meets ? take(t, by, {}) : nullptr;
            if (!hit) {
                if (result.answer != RayAnswer::Traced) result.answer = RayAnswer::Missed;
                return false;
            }
            hit->interpolated = answer.hit;
            hit->local = record->interpolated_local(*query.ray, t, answer);
            return true;
        }
    }
    ShapeHit hit;
    const bool nearer = record->scene->closest(*ray, hit) && take(hit.point.t, by, hit.facet) != nullptr;
    if (nearer)
        *query.traced = hit;
    else if (by == RayAnswer::Traced)
        result.answer = by;
    return nearer;
}

bool Tracer::Implementation::visit_any(const Query& query, uint32_t index) const {
    Maybe<InstanceRecord> room;
    const InstanceRecord* record = records[index].at(query.ray->time, room);
    if (!record) return false;
    const Maybe<LocalRay> ray = local_ray(query, index, *record);
    if (!ray) return false;
    if (record->cache && query.ray->leaves != index) {
        const ObjectAnswer answer = record->ask(*query.ray, *ray, query.differential);
        if (answer.answer != RayAnswer::Traced) {
            const double t = distance_to(answer, *query.ray, *ray);
            return answer.answer != RayAnswer::Missed && t >= query.ray->t_min && t <= query.farthest;
        }
    }
    return record->scene->occluded(*ray);
}

Maybe<LocalRay> Tracer::Implementation::ray_above(const Ray& ray) const {
    const Box3d box((bounds.min - frame.center) / frame.scale, (bounds.max - frame.center) / frame.scale);
    return clipped_ray(box, (ray.origin - frame.center) / frame.scale, ray.direction / frame.scale, ray.t_min,
                       ray.t_max);
}

/// Asks all instances, one by one or through the tree above them; whether any was hit.
bool Tracer::Implementation::ask_all(Query& query) const {
    std::optional<GeometryCache::Reader> reader;
    if (cache) query.reader = &reader.emplace(*cache);
    if (!tree.empty()) return ask_above(query);
    bool found = false;
    for (uint32_t i = 0; i < instances.size() && (query.result || !found); ++i) found |= visit(query, i);
    return found;
}

bool Tracer::Implementation::ask_above(Query& query) const {
    const Maybe<LocalRay> ray = ray_above(*query.ray);
    if (!ray) return false;
    struct Asked {
        const Implementation* tracer;
        Query* query;
        const LocalRay* ray;
        bool found;
    } asked{this, &query, &*ray, false};
    const auto visit_leaf = [](void* owner, uint32_t leaf, uint32_t, float* farthest) {
        Asked& all = *static_cast<Asked*>(owner);
        const LocalRay& above = *all.ray;
        all.tracer->meet_leaf(leaf, above.float_origin, above.float_direction, *farthest, [&](const TreeItem& item) {
            all.query->root = item.root;
            if (!all.tracer->visit(*all.query, item.instance)) return;
            all.found = true;
            *farthest = all.query->result ? above.float_distance(all.query->farthest) : kDone;
        });
    };
    float farthest = ray->float_distance(ray->t_max);
    traversal.alone(tree.nodes(), 0, ray->float_origin, ray->float_direction, &farthest, visitor(visit_leaf, &asked));
    return asked.found;
}

/// Until then a result has no place of what was traced, and the answer of the objects that were missed.
void Tracer::Implementation::finish(const Ray& ray, Maybe<ShapeHit>& traced, ClosestHit& result) const {
    if (!result.hit) return;
    Hit& hit = *result.hit;
    if (hit.answer != RayAnswer::NotAsked) result.answer = hit.answer;
    // In place: copied there, it would wait for its parts, which have just been written.
    if (!hit.is_interpolated())
        new (&hit.local) LocalHit(records[hit.instance].scene->hit_at(*traced, shutter_time(ray.time)));
}

/// What a ray that starts at a hit knows about the ray that found it.
RaySight Tracer::Implementation::sight_from(const Ray& ray, const Hit& hit) const {
    RaySight sight =
        hit.local.seen_by == SeenBy::RayBefore ? *ray.start.sight : RaySight(ray.origin, ray.direction, ray.beam);
    Maybe<InstanceRecord> room;
    sight.reach = kSightReach * hit.local.subpatch_length / records[hit.instance].at(ray.time, room)->shrink;
    return sight;
}

ClosestHit Tracer::Implementation::closest(const RayQuery& asked) const {
    const FloatEnvironment environment;
    ClosestHit result;
    if (!can_hit(*asked.ray)) return result;
    Maybe<ShapeHit> traced;
    Query query{asked, nullptr, asked.ray->t_max, 0, &result, &traced};
    ask_all(query);
    finish(*asked.ray, traced, result);
    return result;
}

}  // namespace rayleaf
