// Packets: up to sixteen rays on their way through the instances together.
//
// Instances with a ray cache, and shapes that take single rays only, are asked ray by ray. A packet gives each ray the
// hit that it would find alone, to the bit: what is nearer is decided in double precision, by the same steps.
#include "trace/float_environment.h"
#include "trace/tracer_queries.h"

#include <algorithm>

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

/// More than a few.
bool are_many(uint32_t lanes) {
    for (int i = 0; i < kFewAboveInstances; ++i) lanes &= lanes - 1;
    return lanes != 0;
}

}  // namespace

void Tracer::Implementation::start(Packet& packet) const {
    if (cache) packet.reader.emplace(*cache);
    for (size_t lane = 0; lane < packet.rays.size(); ++lane) {
        const Ray& ray = *packet.rays[lane].ray;
        if (!can_hit(ray)) continue;
        packet.lanes |= 1u << lane;
        packet.kinds |= packet.rays[lane].kind;
        for (int axis = 0; axis < 3; ++axis) {
            packet.world.origin[axis][lane] = ray.origin[axis];
            packet.world.direction[axis][lane] = ray.direction[axis];
        }
        packet.world.t_min[lane] = ray.t_min;
        packet.world.t_max[lane] = ray.t_max;
    }
}

void Tracer::Implementation::ask_all(Packet& packet) const {
    if (!tree.empty()) return ask_above(packet);
    for (uint32_t i = 0; i < instances.size(); ++i) visit(packet, i, packet.lanes);
}

void Tracer::Implementation::ask_above(Packet& packet) const {
    const double inverse = 1.0 / frame.scale;  // exact: a power of two
    const RayMap map{frame.center, {inverse, 0, 0}, {0, inverse, 0}, {0, 0, inverse}};
    const Box3d box((bounds.min - frame.center) * inverse, (bounds.max - frame.center) * inverse);
    const uint32_t lanes = clip_packet(packet.world, packet.lanes, map, box, packet.above);
    if (lanes == 0) return;
    struct Asked {
        const Implementation* tracer;
        Packet* packet;
    } asked{this, &packet};
    const auto visit_lanes = [](void* owner, uint32_t leaf, uint32_t met, float* farthest) {
        const Asked& all = *static_cast<const Asked*>(owner);
        all.tracer->visit_leaf(*all.packet, leaf, met, farthest);
    };
    alignas(64) float farthest[kPacketSize];
    std::copy_n(packet.above.farthest, kPacketSize, farthest);
    traversal.packet(tree.nodes(), 0, packet.above, lanes, kFewAboveInstances, farthest, visitor(visit_lanes, &asked));
}

/// What few rays meet, each meets in its own order.
void Tracer::Implementation::visit_leaf(Packet& packet, uint32_t leaf, uint32_t lanes, float* farthest) const {
    const RayPacket& above = packet.above;
    if (!are_many(lanes)) {
        for_each_lane(lanes, [&](size_t lane) {
            const auto of_lane = [lane](const float(&rows)[3][kPacketSize]) {
                return Vec3f(rows[0][lane], rows[1][lane], rows[2][lane]);
            };
            meet_leaf(leaf, of_lane(above.near_origin), of_lane(above.unit_direction), farthest[lane],
                      [&](const TreeItem& item) { visit_item(packet, item, 1u << lane, farthest); });
        });
        return;
    }
    MetBoxes met;
    box_kernels.together(leaves[leaf], above, farthest, met);
    float keys[OrientedBoxes::kMost];
    uint32_t entered = 0;
    for (uint32_t box = 0; box < leaves[leaf].count; ++box) {
        met.lanes[box] &= lanes;
        if (met.lanes[box] == 0) continue;
        entered |= 1u << box;
        const int first = __builtin_ctz(met.lanes[box]);
        keys[box] = met.nears[box][first] > 0.0f ? met.nears[box][first] : met.fars[box][first];
    }
    const TreeItem* const held = items_in(leaf).data();
    fetch_records(held, entered);
    uint32_t nearer = 0;
    for_each_by_key(entered, keys, [&](uint32_t box) {
        uint32_t left = met.lanes[box];
        for_each_lane(left & nearer, [&](size_t lane) {
            if (met.nears[box][lane] > farthest[lane]) left &= ~(1u << lane);
        });
        if (left != 0) nearer |= visit_item(packet, held[box], left, farthest);
        return true;
    });
}

/// Returns the lanes that have found something, nearer than what was.
uint32_t Tracer::Implementation::visit_item(Packet& packet, const TreeItem& item, uint32_t lanes,
                                            float* farthest) const {
    packet.shape.root = item.root;
    const uint32_t nearer = visit(packet, item.instance, lanes);
    for_each_lane(nearer, [&](size_t lane) {
        farthest[lane] = packet.results ? float_distance_of(packet.world.t_max[lane], packet.above.start[lane],
                                                            packet.above.speed[lane])
                                        : kDone;
    });
    return nearer;
}

uint32_t Tracer::Implementation::visit(Packet& packet, uint32_t index, uint32_t lanes) const {
    const InstanceRecord& record = records[index];
    if (!packet.results) lanes &= ~packet.found;
    const auto keep = [&](const auto& holds) {
        for_each_lane(lanes, [&](size_t lane) {
            if (!holds(packet.rays[lane])) lanes &= ~(1u << lane);
        });
    };
    const bool all_see = (packet.kinds & ~record.visibility) == 0;
    if (!all_see) keep([&](const RayQuery& asked) { return (asked.kind & record.visibility) != 0; });
    if (packet.passed && passages[index] != LightPassage::Closed) return visit_open(packet, index, lanes);
    if (!record.scene->takes_packets() || !are_many(lanes)) return visit_alone(packet, index, lanes);
    if (!record.cache) return visit_together(packet, index, lanes);
    const uint32_t all = lanes;
    keep([&](const RayQuery& asked) { return asked.ray->leaves == index; });
    if (!are_many(lanes)) return visit_alone(packet, index, all);
    return visit_alone(packet, index, all & ~lanes) | visit_together(packet, index, lanes);
}

uint32_t Tracer::Implementation::visit_alone(Packet& packet, uint32_t index, uint32_t lanes) const {
    uint32_t nearer = 0;
    for_each_lane(lanes, [&](size_t lane) {
        Query query{packet.rays[lane], packet.reader ? &*packet.reader : nullptr,        packet.world.t_max[lane],
                    packet.shape.root, packet.results ? packet.results + lane : nullptr, &packet.traced[lane]};
        if (!visit(query, index)) return;
        packet.world.t_max[lane] = query.farthest;
        nearer |= 1u << lane;
    });
    packet.found |= nearer;
    return nearer;
}

/// The lanes of `packet.shape` that meet a moving instance: each ray where the instance is at its time.
uint32_t Tracer::Implementation::into_shape(Packet& packet, const InstanceRecord& record, uint32_t lanes) const {
    uint32_t met = 0;
    Maybe<InstanceRecord> room;
    for_each_lane(lanes, [&](size_t lane) {
        const Ray& world_ray = *packet.rays[lane].ray;
        const InstanceRecord* now = record.at(world_ray.time, room);
        if (!now) return;
        const Maybe<LocalRay> ray =
            clipped_ray(record.scene->box(), now->point_to_local(world_ray.origin),
                        now->vector_to_local(world_ray.direction), world_ray.t_min, packet.world.t_max[lane]);
        if (!ray) return;
        set_lane(packet.shape.rays, lane, *ray);
        met |= 1u << lane;
    });
    return met;
}

/// Makes `packet.shape` ask the shape of an instance; false if no ray may meet it.
bool Tracer::Implementation::enter_shape(Packet& packet, uint32_t index, uint32_t lanes) const {
    const InstanceRecord& record = records[index];
    PacketQuery& shape = packet.shape;
    if (record.scene->box().isEmpty()) return false;
    for_each_lane(lanes, [&](size_t lane) {
        const RayStart& from = packet.rays[lane].ray->start;
        shape.rays.start_facet[lane] = from.instance == index ? from.facet : RayAnchor::kNone;
    });
    shape.lanes = record.motion ? into_shape(packet, record, lanes)
                                : clip_packet(packet.world, lanes, record.to_local, record.scene->box(), shape.rays);
    if (record.scene->deforms())
        for_each_lane(shape.lanes, [&](size_t lane) { shape.times[lane] = shutter_time(packet.rays[lane].ray->time); });
    return shape.lanes != 0;
}

uint32_t Tracer::Implementation::visit_together(Packet& packet, uint32_t index, uint32_t lanes) const {
    if (!enter_shape(packet, index, lanes)) return 0;
    const InstanceRecord& record = records[index];
    PacketQuery& shape = packet.shape;
    if (packet.results) {
        record.scene->find_closest(shape);
        return take_nearest(packet, index);
    }
    record.scene->find_any(shape);
    packet.found |= shape.found;
    return shape.found;
}

/// An instance that may let rays through. Returns the lanes that need not go on.
uint32_t Tracer::Implementation::visit_open(Packet& packet, uint32_t index, uint32_t lanes) const {
    const ShapeScene& scene = *records[index].scene;
    const bool finds_all = passages[index] == LightPassage::Surface && !records[index].cache && scene.finds_all();
    if (finds_all && scene.takes_packets() && are_many(lanes)) {
        if (!enter_shape(packet, index, lanes)) return 0;
        scene.find_any(packet.shape);
        lanes = packet.shape.found;
    }
    uint32_t closed = 0;
    Maybe<InstanceRecord> room;
    for_each_lane(lanes, [&](size_t lane) {
        const Ray& world_ray = *packet.rays[lane].ray;
        PassedHits& passed = packet.passed[lane];
        const InstanceRecord* record = records[index].at(world_ray.time, room);
        if (!record) return;
        if (!finds_all) {
            const Query query{packet.rays[lane], packet.reader ? &*packet.reader : nullptr,
                              world_ray.t_max,   packet.shape.root,
                              nullptr,           nullptr};
            if (visit_any(query, index)) passed.set_unknown();
            return;
        }
        Maybe<LocalRay> ray = record->local_ray(index, world_ray, world_ray.t_max);
        if (ray) ray->root = packet.shape.root;
        if (ray && scene.find_all(*ray, index, passed)) closed |= 1u << lane;
    });
    packet.found |= closed;
    return closed;
}

/// What the shape of an instance has found.
uint32_t Tracer::Implementation::take_nearest(Packet& packet, uint32_t index) const {
    uint32_t nearer = 0;
    for_each_lane(packet.shape.found, [&](size_t lane) {
        const PacketQuery::Best& best = *packet.shape.best[lane];
        const double t = best.point.t;
        Maybe<Hit>& hit = packet.results[lane].hit;
        if (hit && t == packet.world.t_max[lane] &&
            !goes_first(index, best.facet, packet.results[lane], packet.traced[lane]))
            return;
        hit.emplace(t, index, RayAnswer::NotAsked);
        packet.world.t_max[lane] = t;
        packet.traced[lane].emplace(best.facet, best.point);
        nearer |= 1u << lane;
    });
    packet.found |= nearer;
    return nearer;
}

void Tracer::closest(std::span<const RayQuery> rays, Coherence coherence, ClosestHit* results) const {
    const FloatEnvironment environment;
    for (size_t lane = 0; lane < rays.size(); ++lane) {
        results[lane].hit.reset();
        results[lane].answer = RayAnswer::NotAsked;
    }
    Implementation::Packet packet(rays, coherence, results);
    implementation_->start(packet);
    implementation_->ask_all(packet);
    for (size_t lane = 0; lane < rays.size(); ++lane)
        implementation_->finish(*rays[lane].ray, packet.traced[lane], results[lane]);
}

uint32_t Tracer::occluded(std::span<const RayQuery> rays, Coherence coherence) const {
    const FloatEnvironment environment;
    Implementation::Packet packet(rays, coherence, nullptr);
    implementation_->start(packet);
    implementation_->ask_all(packet);
    return packet.found;
}

void Tracer::pass(std::span<const RayQuery> rays, Coherence coherence, PassedHits* passed) const {
    const FloatEnvironment environment;
    Implementation::Packet packet(rays, coherence, nullptr);
    packet.passed = passed;
    implementation_->start(packet);
    implementation_->ask_all(packet);
    for_each_lane(packet.found, [&](size_t lane) { passed[lane].close(); });
}

}  // namespace rayleaf
