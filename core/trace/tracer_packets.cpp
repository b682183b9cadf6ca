// Packets: up to sixteen rays on their way through the instances together.
//
// Instances with a ray cache, and shapes that take single rays only, are asked ray by ray. A packet gives each ray the
// hit that it would find alone, to the bit: what is nearer is decided in double precision, by the same steps.
#include "trace/float_environment.h"
#include "trace/tracer_queries.h"

#include <bit>
#include <limits>

namespace rayleaf {
namespace {

/// So few rays meet an instance faster one by one.
constexpr int kFewRays = 2;

void set_ray(const LocalRay& local, size_t lane, RTCRay16& rays) {
    const RTCRay ray = local.embree_ray();
    rays.org_x[lane] = ray.org_x;
    rays.org_y[lane] = ray.org_y;
    rays.org_z[lane] = ray.org_z;
    rays.tnear[lane] = ray.tnear;
    rays.dir_x[lane] = ray.dir_x;
    rays.dir_y[lane] = ray.dir_y;
    rays.dir_z[lane] = ray.dir_z;
    rays.time[lane] = ray.time;
    rays.tfar[lane] = ray.tfar;
    rays.mask[lane] = ray.mask;
    rays.id[lane] = ray.id;
    rays.flags[lane] = ray.flags;
}

}  // namespace

void Tracer::Implementation::start(Packet& packet, std::span<const RayQuery> rays) const {
    initialize(packet.context);
    packet.tracer = this;
    if (cache) packet.reader.emplace(*cache);
    for (size_t lane = 0; lane < rays.size(); ++lane) {
        Query& query = packet.queries[lane];
        query.differential = rays[lane].differential;
        if (!start(query, *rays[lane].ray, rays[lane].kind)) continue;
        query.reader = packet.reader ? &*packet.reader : nullptr;
        packet.lanes |= 1u << lane;
    }
}

void Tracer::Implementation::ask_all(Packet& packet, Wanted wanted) const {
    if (scene) return ask_above(packet, wanted);
    for (uint32_t i = 0; i < instances.size(); ++i) visit(packet, i, packet.lanes, wanted);
}

void Tracer::Implementation::ask_above(Packet& packet, Wanted wanted) const {
    alignas(64) int valid[kPacketSize] = {};
    RTCRayHit16 rays;
    for_each_lane(packet.lanes, [&](size_t lane) {
        Query& query = packet.queries[lane];
        query.scene_ray = ray_above(*query.ray);
        if (!query.scene_ray) return;
        valid[lane] = -1;
        set_ray(*query.scene_ray, lane, rays.ray);
        rays.hit.geomID[lane] = rays.hit.primID[lane] = rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    });
    if (wanted == Wanted::Any)
        embree_any16(valid, scene.get(), packet.context, packet.shape.coherence, rays.ray);
    else
        embree_closest16(valid, scene.get(), packet.context, packet.shape.coherence, rays);
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
    if (std::popcount(together) > kFewRays)
        visit_shape(packet, index, together, wanted);
    else
        for_each_lane(together, [&](size_t lane) { visit_alone(packet.queries[lane], index, wanted); });
}

void Tracer::Implementation::visit_shape(Packet& packet, uint32_t index, uint32_t lanes, Wanted wanted) const {
    PacketQuery& shape = packet.shape;
    shape.clear();
    for_each_lane(lanes, [&](size_t lane) {
        std::optional<LocalRay>& local = packet.local_rays[lane];
        local = local_ray(packet.queries[lane], index);
        if (local) shape.add(lane, *local, packet.hits[lane]);
    });
    if (shape.lanes == 0) return;
    wanted == Wanted::Any ? records[index].scene->occluded(shape) : records[index].scene->closest(shape);
    for_each_lane(shape.lanes, [&](size_t lane) {
        const FacetQuery& found = shape.facets[lane];
        Query& query = packet.queries[lane];
        if (!found.found || (query.found && found.farthest == query.farthest && query.instance < index)) return;
        query.best = packet.hits[lane];
        query.farthest = found.farthest;
        query.answer = RayAnswer::NotAsked;
        query.instance = index;
        query.found = true;
    });
}

void Tracer::Implementation::packet_closest_callback(const RTCIntersectFunctionNArguments* arguments) {
    const uint32_t lanes = lanes_of(arguments->valid, arguments->N);
    if (lanes == 0) return;
    Packet& packet = Packet::of(arguments->context);
    packet.tracer->visit(packet, arguments->primID, lanes, Wanted::Closest);
    float* t_max = &RTCRayN_tfar(RTCRayHitN_RayN(arguments->rayhit, arguments->N), arguments->N, 0);
    for_each_lane(lanes, [&](size_t lane) {
        const Query& query = packet.queries[lane];
        if (query.found) t_max[lane] = query.scene_ray->float_distance(query.farthest);
    });
}

void Tracer::Implementation::packet_any_callback(const RTCOccludedFunctionNArguments* arguments) {
    const uint32_t lanes = lanes_of(arguments->valid, arguments->N);
    if (lanes == 0) return;
    Packet& packet = Packet::of(arguments->context);
    packet.tracer->visit(packet, arguments->primID, lanes, Wanted::Any);
    float* t_max = &RTCRayN_tfar(arguments->ray, arguments->N, 0);
    for_each_lane(lanes, [&](size_t lane) {
        if (packet.queries[lane].found) t_max[lane] = -std::numeric_limits<float>::infinity();
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
