// Packets: up to sixteen rays on their way through the instances together.
//
// Instances with a ray cache, and shapes that take single rays only, are asked ray by ray. A packet gives each ray the
// hit that it would find alone, to the bit: what is nearer is decided in double precision, by the same steps.
#include "trace/float_environment.h"
#include "trace/tracer_queries.h"

#include <algorithm>
#include <bit>

namespace rayleaf {
namespace {

/// So few rays meet an instance faster one by one.
constexpr int kFewAboveInstances = 2;

/// As ClipPacket sets it.
void set_lane(RayPacket& rays, size_t lane, const LocalRay& ray) {
    for (int axis = 0; axis < 3; ++axis) {
        rays.origin[axis][lane] = ray.origin[axis];
        rays.direction[axis][lane] = ray.direction[axis];
        rays.near_origin[axis][lane] = ray.float_origin[axis];
        rays.unit_direction[axis][lane] = ray.float_direction[axis];
    }
    rays.t_min[lane] = ray.t_min;
    rays.t_max[lane] = ray.t_max;
    rays.start[lane] = ray.start;
    rays.speed[lane] = ray.speed;
    rays.farthest[lane] = ray.float_distance(ray.t_max);
    const double from = (ray.t_min - ray.start) * ray.speed, to = (ray.t_max - ray.start) * ray.speed;
    const double margin = 2.0 * kBackstep + std::abs(ray.start) * ray.speed * 0x1p-49;
    rays.sure_from[lane] = static_cast<float>(from + margin);
    rays.sure_to[lane] = static_cast<float>(to * (1.0 - 0x1p-20) - margin);
}

}  // namespace

void Tracer::Implementation::start(Packet& packet, std::span<const RayQuery> rays) const {
    if (cache) packet.reader.emplace(*cache);
    for (size_t lane = 0; lane < rays.size(); ++lane) {
        Query& query = packet.queries[lane];
        query.differential = rays[lane].differential;
        if (!start(query, *rays[lane].ray, rays[lane].kind)) continue;
        query.reader = packet.reader ? &*packet.reader : nullptr;
        packet.lanes |= 1u << lane;
        for (int axis = 0; axis < 3; ++axis) {
            packet.world.origin[axis][lane] = query.ray->origin[axis];
            packet.world.direction[axis][lane] = query.ray->direction[axis];
        }
        packet.world.t_min[lane] = query.ray->t_min;
        packet.world.t_max[lane] = query.ray->t_max;
    }
}

void Tracer::Implementation::ask_all(Packet& packet, Wanted wanted) const {
    if (!tree.empty()) return ask_above(packet, wanted);
    for (uint32_t i = 0; i < instances.size(); ++i) visit(packet, i, packet.lanes, wanted);
}

void Tracer::Implementation::ask_above(Packet& packet, Wanted wanted) const {
    const double inverse = 1.0 / frame.scale;  // exact: a power of two
    const RayMap map{frame.center, {inverse, 0, 0}, {0, inverse, 0}, {0, 0, inverse}};
    const Box3d box((bounds.min - frame.center) * inverse, (bounds.max - frame.center) * inverse);
    const uint32_t lanes = clip_packet(packet.world, packet.lanes, map, box, packet.above);
    if (lanes == 0) return;
    struct Asked {
        const Implementation* tracer;
        Packet* packet;
        Wanted wanted;
    } asked{this, &packet, wanted};
    const auto visit_lanes = [](void* owner, uint32_t index, uint32_t met, float* farthest) {
        const Asked& all = *static_cast<const Asked*>(owner);
        Packet& rays = *all.packet;
        all.tracer->visit(rays, index, met, all.wanted);
        for_each_lane(met, [&](size_t lane) {
            const Query& query = rays.queries[lane];
            if (!query.found) return;
            farthest[lane] = all.wanted == Wanted::Any
                                 ? kDone
                                 : float_distance_of(query.farthest, rays.above.start[lane], rays.above.speed[lane]);
        });
    };
    alignas(64) float farthest[kPacketSize];
    std::copy_n(packet.above.farthest, kPacketSize, farthest);
    traversal.packet(tree.nodes(), packet.above, lanes, kFewAboveInstances, farthest, {visit_lanes, &asked});
}

void Tracer::Implementation::visit(Packet& packet, uint32_t index, uint32_t lanes, Wanted wanted) const {
    uint32_t together = 0;
    for_each_lane(lanes, [&](size_t lane) {
        Query& query = packet.queries[lane];
        if (wanted == Wanted::Any && query.found) return;
        const bool asks_cache = records[index].cache && query.ray->leaves != index;
        if (asks_cache || !records[index].scene->takes_packets())
            visit_alone(query, index, wanted);
        else
            together |= 1u << lane;
    });
    if (std::popcount(together) > kFewAboveInstances)
        visit_shape(packet, index, together, wanted);
    else
        for_each_lane(together, [&](size_t lane) { visit_alone(packet.queries[lane], index, wanted); });
}

/// The lanes of `packet.shape` that meet a moving instance: each ray where the instance is at its time.
uint32_t Tracer::Implementation::into_shape(Packet& packet, const InstanceRecord& record, uint32_t lanes) const {
    uint32_t met = 0;
    std::optional<InstanceRecord> room;
    for_each_lane(lanes, [&](size_t lane) {
        const Query& query = packet.queries[lane];
        const InstanceRecord* now = record.at(query.ray->time, room);
        if (!now) return;
        const std::optional<LocalRay> ray =
            clipped_ray(record.scene->box(), now->point_to_local(query.ray->origin),
                        now->vector_to_local(query.ray->direction), query.ray->t_min, query.farthest);
        if (!ray) return;
        set_lane(packet.shape.rays, lane, *ray);
        met |= 1u << lane;
    });
    return met;
}

void Tracer::Implementation::visit_shape(Packet& packet, uint32_t index, uint32_t lanes, Wanted wanted) const {
    const InstanceRecord& record = records[index];
    if (record.scene->box().isEmpty()) return;
    PacketQuery& shape = packet.shape;
    for_each_lane(lanes, [&](size_t lane) {
        const Query& query = packet.queries[lane];
        if ((records[index].visibility & query.kind) == 0) lanes &= ~(1u << lane);
        packet.world.t_max[lane] = query.farthest;
        const RayStart& from = query.ray->start;
        shape.rays.start_facet[lane] = from.instance == index ? from.facet : RayAnchor::kNone;
    });
    shape.lanes = record.motion ? into_shape(packet, record, lanes)
                                : clip_packet(packet.world, lanes, record.to_local(), record.scene->box(), shape.rays);
    if (shape.lanes == 0) return;
    if (record.scene->deforms())
        for_each_lane(shape.lanes,
                      [&](size_t lane) { shape.times[lane] = shutter_time(packet.queries[lane].ray->time); });
    if (wanted == Wanted::Any) {
        record.scene->find_any(shape);
        for_each_lane(shape.found, [&](size_t lane) { packet.queries[lane].found = true; });
        return;
    }
    record.scene->find_closest(shape);
    for_each_lane(shape.found, [&](size_t lane) {
        const PacketQuery::Best& best = shape.best[lane];
        Query& query = packet.queries[lane];
        if (query.found && best.point.t == query.farthest && query.instance < index) return;
        query.best.facet = best.facet;
        query.best.point = best.point;
        query.best.normal = best.normal;
        query.farthest = best.point.t;
        query.answer = RayAnswer::NotAsked;
        query.instance = index;
        query.found = true;
    });
}

void Tracer::closest(std::span<const RayQuery> rays, Coherence coherence, ClosestHit* results) const {
    const FloatEnvironment environment;
    Implementation::Packet packet(coherence);
    implementation_->start(packet, rays);
    implementation_->ask_all(packet, Implementation::Wanted::Closest);
    for (size_t lane = 0; lane < rays.size(); ++lane) {
        results[lane].hit.reset();
        results[lane].answer = implementation_->answer(packet.queries[lane], results[lane].hit);
    }
}

uint32_t Tracer::occluded(std::span<const RayQuery> rays, Coherence coherence) const {
    const FloatEnvironment environment;
    Implementation::Packet packet(coherence);
    implementation_->start(packet, rays);
    implementation_->ask_all(packet, Implementation::Wanted::Any);
    uint32_t hit = 0;
    for (size_t lane = 0; lane < rays.size(); ++lane) hit |= packet.queries[lane].found ? 1u << lane : 0u;
    return hit;
}

}  // namespace rayleaf
