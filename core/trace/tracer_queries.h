// What a tracer holds, and how rays go through it: shared by the files that implement Tracer.
#pragma once

#include "tessellation/geometry_cache.h"
#include "trace/box_traversal.h"
#include "trace/clipped_packet.h"
#include "trace/instance_table.h"
#include "trace/local_ray.h"
#include "trace/shape_scene.h"
#include "trace/traced_shape_store.h"
#include "trace/tracer.h"

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace rayleaf {

struct Tracer::Implementation : InstanceTable {
    std::vector<std::shared_ptr<const LocalRayCache>> caches;  ///< that the records use, by instance; or none at all
    TracedShapeStore* store = nullptr;                         ///< gets the table back; null: nobody does
    BoxTraversal traversal = box_traversal();
    ClipPacket clip_packet = clip_kernel();
    std::unique_ptr<GeometryCache> cache;  ///< null without patches
    uint64_t embree_held = 0;  ///< what Embree held more after the build; tracers built at the same time blur it

    /// One ray on its way through the instances.
    struct Query {
        const GeometryCache::Reader* reader = nullptr;  ///< where there is a cache
        const Ray* ray = nullptr;
        const RayDifferential* differential = nullptr;  ///< of `ray`; null: changes of hits are not needed
        Visibility kind = kVisibleAll;
        ShapeHit best;
        uint32_t instance = 0;
        double farthest = 0;  ///< world t of the best hit, or the ray's t_max
        bool found = false;
        std::optional<ObjectAnswer> interpolated;  ///< the best hit, where it is no facet's
        /// How the objects that were asked answered: that of the best hit, and of those that were missed.
        RayAnswer answer = RayAnswer::NotAsked, missed = RayAnswer::NotAsked;
    };

    void build_cache(const GeometryCacheSettings& settings);
    void give_back_table();
    /// An instance's record at a time, in `room` where it moves.
    const InstanceRecord& record_at(uint32_t instance, float time, std::optional<InstanceRecord>& room) const;

    /// `record` is the instance's at the ray's time.
    std::optional<LocalRay> local_ray(const Query& query, uint32_t index, const InstanceRecord& record) const;
    /// The nearest hit, and how objects with caches answered.
    RayAnswer find(const Ray& ray, Visibility kind, const RayDifferential* differential, std::optional<Hit>& hit) const;
    void visit_closest(Query& query, uint32_t index) const;
    bool take_interpolated(Query& query, uint32_t index, const LocalRay& ray, const ObjectAnswer& answer) const;
    void visit_any(Query& query, uint32_t index) const;
    bool start(Query& query, const Ray& ray, Visibility kind) const;
    std::optional<LocalRay> ray_above(const Ray& ray) const;
    enum class Wanted : uint8_t { Closest, Any };
    void ask_all(Query& query, Wanted wanted) const;
    void ask_above(Query& query, Wanted wanted) const;
    void set_hit(Query& query, Hit& hit) const;
    RaySight sight_from(const Ray& ray, const Hit& hit) const;

    /// Up to sixteen rays that go through the instances together.
    struct Packet {
        uint32_t lanes = 0;  ///< those that can hit anything, a bit each
        WorldPacket world;   ///< t_max: what is left of it
        std::array<Query, kPacketSize> queries;
        std::optional<GeometryCache::Reader> reader;
        RayPacket above;    ///< in the space of the tree
        PacketQuery shape;  ///< in one shape after the other

        explicit Packet(Coherence coherence) : shape(coherence) {}
    };
    void start(Packet& packet, std::span<const RayQuery> rays) const;
    void ask_all(Packet& packet, Wanted wanted) const;
    void ask_above(Packet& packet, Wanted wanted) const;
    void visit(Packet& packet, uint32_t index, uint32_t lanes, Wanted wanted) const;
    void visit_alone(Query& query, uint32_t index, Wanted wanted) const {
        wanted == Wanted::Any ? visit_any(query, index) : visit_closest(query, index);
    }
    void visit_shape(Packet& packet, uint32_t index, uint32_t lanes, Wanted wanted) const;
    uint32_t into_shape(Packet& packet, const InstanceRecord& record, uint32_t lanes) const;
    RayAnswer answer(Query& query, std::optional<Hit>& hit) const;
};

}  // namespace rayleaf
