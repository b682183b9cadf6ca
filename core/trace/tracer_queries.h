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
    OrientedBoxKernels box_kernels = oriented_box_kernels();
    ClipPacket clip_packet = clip_kernel();
    std::unique_ptr<GeometryCache> cache;  ///< null without patches
    std::vector<LightPassage> passages;    ///< of instances; none: all are closed
    uint64_t embree_held = 0;  ///< what Embree held more after the build; tracers built at the same time blur it

    /// One ray on its way through the instances.
    struct Query : RayQuery {
        const GeometryCache::Reader* reader = nullptr;  ///< where there is a cache
        double farthest = 0;                            ///< world t of the nearest hit so far, or the ray's t_max
        uint32_t root = 0;                              ///< of the part of an instance that is asked
        ClosestHit* result = nullptr;                   ///< gets the nearest hit; null: any will do
        Maybe<ShapeHit>* traced = nullptr;              ///< gets what the hit's place is made of in the end (`finish`)
    };

    void build_cache(const GeometryCacheSettings& settings);
    void give_back_table();
    /// An instance's record at a time, in `room` where it moves.
    const InstanceRecord& record_at(uint32_t instance, float time, Maybe<InstanceRecord>& room) const;

    /// `record` is the instance's at the ray's time.
    Maybe<LocalRay> local_ray(const Query& query, uint32_t index, const InstanceRecord& record) const;
    ClosestHit closest(const RayQuery& asked) const;
    /// These return whether they have found something, nearer than what was.
    bool visit_closest(Query& query, uint32_t index) const;
    bool visit_any(const Query& query, uint32_t index) const;
    bool visit(Query& query, uint32_t index) const {
        if ((records[index].visibility & query.kind) == 0) return false;
        return query.result ? visit_closest(query, index) : visit_any(query, index);
    }
    bool can_hit(const Ray& ray) const { return !bounds.isEmpty() && is_traceable(ray); }
    Maybe<LocalRay> ray_above(const Ray& ray) const;
    bool ask_all(Query& query) const;
    bool ask_above(Query& query) const;
    /// Of the tree above the instances.
    BoxVisitor visitor(BoxVisitor::Visit meet, void* owner) const {
        return {meet, owner, leaves.data(), sizeof(OrientedBoxes)};
    }
    /// Calls `visit` with what a ray above the instances may meet of a leaf, the nearest first, as far as `farthest`,
    /// which it may lower.
    template <typename Visit>
    void meet_leaf(uint32_t leaf, const Vec3f& origin, const Vec3f& direction, const float& farthest,
                   const Visit& visit) const {
        float nears[OrientedBoxes::kMost];
        const uint32_t met = box_kernels.alone(leaves[leaf], origin, direction, farthest, nears);
        const TreeItem* const held = items_in(leaf).data();
        fetch_records(held, met);
        for_each_by_key(met, nears, [&](uint32_t box) {
            if (!(nears[box] <= farthest)) return false;
            visit(held[box]);
            return true;
        });
    }
    /// What rays read of them, ahead of the first.
    void fetch_records(const TreeItem* held, uint32_t bits) const {
        for (; bits != 0; bits &= bits - 1) {
            const InstanceRecord& record = records[held[__builtin_ctz(bits)].instance];
            __builtin_prefetch(&record);
            __builtin_prefetch(&record.to_local.y);
        }
    }
    /// Whether a hit comes first among equally distant ones. `result` is one that was found before, `traced` its facet.
    static bool goes_first(uint32_t instance, const FacetId& facet, const ClosestHit& result,
                           const Maybe<ShapeHit>& traced) {
        if (instance != result.hit->instance) return instance < result.hit->instance;
        return facet < traced->facet;  // on another part of the instance
    }
    void finish(const Ray& ray, Maybe<ShapeHit>& traced, ClosestHit& result) const;
    RaySight sight_from(const Ray& ray, const Hit& hit) const;

    /// Up to sixteen rays that go through the instances together, by lane.
    struct Packet {
        std::span<const RayQuery> rays;
        ClosestHit* results;                              ///< as of Query
        PassedHits* passed = nullptr;                     ///< where there are no results: gets what lets rays through
        uint32_t lanes = 0;                               ///< those that can hit anything, a bit each
        uint32_t found = 0;                               ///< those that have hit something
        uint64_t kinds = 0;                               ///< of any of the rays
        WorldPacket world;                                ///< t_max: Query's `farthest`
        std::array<Maybe<ShapeHit>, kPacketSize> traced;  ///< as of Query
        std::optional<GeometryCache::Reader> reader;
        RayPacket above;    ///< in the space of the tree
        PacketQuery shape;  ///< in one shape after the other

        Packet(std::span<const RayQuery> asked, Coherence coherence, ClosestHit* closest)
            : rays(asked), results(closest), shape(coherence) {}
    };
    void start(Packet& packet) const;
    void ask_all(Packet& packet) const;
    void ask_above(Packet& packet) const;
    void visit_leaf(Packet& packet, uint32_t leaf, uint32_t lanes, float* farthest) const;
    uint32_t visit_item(Packet& packet, const TreeItem& item, uint32_t lanes, float* farthest) const;
    /// These return the lanes that have found something, nearer than what was.
    uint32_t visit(Packet& packet, uint32_t index, uint32_t lanes) const;
    uint32_t visit_alone(Packet& packet, uint32_t index, uint32_t lanes) const;
    bool enter_shape(Packet& packet, uint32_t index, uint32_t lanes) const;
    uint32_t visit_open(Packet& packet, uint32_t index, uint32_t lanes) const;
    uint32_t visit_together(Packet& packet, uint32_t index, uint32_t lanes) const;
    uint32_t take_nearest(Packet& packet, uint32_t index) const;
    uint32_t into_shape(Packet& packet, const InstanceRecord& record, uint32_t lanes) const;
};

}  // namespace rayleaf
