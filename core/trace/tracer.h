// Rays against all instances of a scene: closest hit, any hit, and the surface point of a hit.
//
// A ray that meets the box of an instance in the tree above them is moved to the shape's local space in double
// precision, with the origin drawn near the shape, and traces it there in float. So an object of size 1 at 10^6
// renders as it does at 0, and an object with a ray cache can be asked before it is traced.
#pragma once

#include "base/cancel.h"
#include "base/chunked_vector.h"
#include "base/maybe.h"
#include "base/vector.h"
#include "geometry/shape.h"
#include "geometry/surface_point.h"
#include "rays/hit.h"
#include "rays/packet.h"
#include "rays/ray.h"
#include "splines/limit_normal.h"
#include "tessellation/geometry_cache.h"
#include "trace/local_ray_cache.h"
#include "trace/passed_hits.h"
#include "trace/visibility.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace rayleaf {

struct TracedInstance {
    std::shared_ptr<const Shape> shape;
    Affine3d object_to_world;  ///< must be regular; checked where the scene is described
    uint64_t visibility = seen_by(kVisibleAll);
    /// Where it is while the shutter is open; null: it stands still at `object_to_world`.
    std::shared_ptr<const Motion> motion = nullptr;

    bool operator==(const TracedInstance&) const = default;
};

/// The usual one of DicingView. Lenses and lamps enlarge what is small in the picture: a circle keeps 70 sides.
inline constexpr double kCoarsestTolerance = 1e-3;
/// The usual one of facets that go through the geometry cache: its coarsest level has one for 16 x 16 of these.
inline constexpr double kCoarsestCachedTolerance = 1e-4;

/// How finely patches are diced. The grid of a subpatch has 17x17 vertices; patches are split evenly until the distance
/// between facets and surface is below `tolerance(instance)`.
struct DicingView {
    Vec3d eye{0, 0, 0};         ///< world
    double pixel_angle = 1e-3;  ///< radians a pixel spans; 0 for orthographic views
    double pixel_width = 0;     ///< world units a pixel spans in orthographic views
    double pixels = 0.1;        ///< wanted distance between facet and surface, in pixels
    /// The largest such distance, whatever the view says: local units, where a shape's half extent is between 1/2 and
    /// 1.
    double coarsest = kCoarsestTolerance;
    double coarsest_cached = kCoarsestCachedTolerance;  ///< of facets that go through the geometry cache

    bool operator==(const DicingView&) const = default;
};

struct TraceStatistics {
    uint64_t subpatches = 0, bvh_bytes = 0, triangles = 0, instances = 0, shapes = 0;
    uint64_t record_bytes = 0;         ///< what is held for each subpatch beside the tree, the grids and the facets
    uint64_t opened_instances = 0;     ///< that the tree above them holds in parts
    uint64_t kept_shapes = 0;          ///< that were not built for this tracer (trace/traced_shape_store.h)
    uint64_t resident_shapes = 0;      ///< diced shapes whose facets stay in memory
    uint64_t facet_bytes = 0;          ///< of those facets
    GeometryCacheStatistics geometry;  ///< all zero without patches
    NormalCounters limit_normals;      ///< of hits on patches where the surface has no normal of its own, by stage
};

/// A closest hit, and how the objects with ray caches on the way answered.
struct ClosestHit {
    Maybe<Hit> hit;
    RayAnswer answer = RayAnswer::NotAsked;  ///< the hit's; without one, of the objects that were asked
};

/// A ray of a packet.
struct RayQuery {
    const Ray* ray = nullptr;
    Visibility kind = kVisibleAll;
    const RayDifferential* differential = nullptr;  ///< as of Tracer::closest
};

/// A hit whose surface point is wanted.
struct SurfaceQuery {
    const Ray* ray = nullptr;
    const Hit* hit = nullptr;
    SurfacePoint* point = nullptr;  ///< where to put it
};

/// A point chosen on an element of an instance, for emitting surfaces, whose surface point is wanted.
struct ElementQuery {
    uint32_t instance = 0;
    LocalHit hit;
    float time = kMiddleTime;       ///< of the shutter
    SurfacePoint* point = nullptr;  ///< where to put it
};

class TracedShapeStore;  // trace/traced_shape_store.h

class Tracer {
  public:
    /// What `kept` knows is not made again; it may be null, else it must outlive the tracer. Throws Cancelled soon
    /// after `cancel` says so.
    Tracer(ChunkedVector<TracedInstance> instances, const DicingView& view, const CancelToken& cancel = kNeverCancelled,
           const GeometryCacheSettings& cache = {}, TracedShapeStore* kept = nullptr);
    ~Tracer();
    Tracer(const Tracer&) = delete;
    Tracer& operator=(const Tracer&) = delete;

    /// From now on, rays ask this cache before any of the instances is traced; null: they do not. Not while rays are
    /// under way. A ray that starts on the instance is traced there: a line says nothing about what lies beyond its
    /// first hit.
    void set_cache(std::span<const uint32_t> instances, const std::shared_ptr<const LocalRayCache>& cache);
    const LocalRayCache* cache(uint32_t instance) const;

    /// The nearest hit in [t_min, t_max]; ties go to the lower instance, then primitive. Thread-safe; a ray that is not
    /// finite or has a zero direction hits nothing.
    Maybe<Hit> closest_hit(const Ray& ray, Visibility kind) const;
    /// With `differential`, the ray's, an interpolated hit knows how it changes.
    ClosestHit closest(const Ray& ray, Visibility kind, const RayDifferential* differential = nullptr) const;
    /// The same for up to kPacketSize rays at once: the same bits, in less time. `results` has one for each ray.
    void closest(std::span<const RayQuery> rays, Coherence coherence, ClosestHit* results) const;
    /// The nearest hit on one instance, by tracing alone.
    Maybe<Hit> closest_on(uint32_t instance, const Ray& ray) const;
    /// How much of [t_min, t_max] lies inside an instance, world units, regardless of visibility.
    LengthAnswer length_inside(uint32_t instance, const Ray& ray) const;
    /// Whether anything lies in [t_min, t_max].
    bool occluded(const Ray& ray, Visibility kind) const;
    /// The same for up to kPacketSize rays at once, a bit each.
    uint32_t occluded(std::span<const RayQuery> rays, Coherence coherence) const;
    /// What each instance may let through; none: nothing does. Before any ray.
    void set_passages(std::vector<LightPassage> passages);
    /// Whether `pass` finds what lets rays through, of some instance at least.
    bool finds_passages() const;
    /// What up to kPacketSize rays meet up to their ends; `passed` has been started, one for each.
    void pass(std::span<const RayQuery> rays, Coherence coherence, PassedHits* passed) const;
    /// As one of them has met it.
    Hit hit_of(const Ray& ray, const PassedHit& passed) const;
    /// Everything about a hit that shading needs, in world space.
    SurfacePoint surface_point(const Ray& ray, const Hit& hit, SurfaceDetail detail = SurfaceDetail::Curvature) const;
    /// The same for many hits at once: the same bits, in less time.
    void surface_points(std::span<const SurfaceQuery> queries, SurfaceDetail detail) const;
    /// The same for a point chosen on an element of an instance; `time` of the shutter. `t` is 0.
    SurfacePoint surface_point(uint32_t instance, const LocalHit& hit, float time = kMiddleTime) const;
    /// The same for many; normals do not change around them.
    void surface_points(std::span<const ElementQuery> queries) const;
    /// As for one, but for what only shading needs: place and facet alone.
    SurfacePoint place(uint32_t instance, const LocalHit& hit, float time) const;

    const TracedInstance& instance(uint32_t index) const;
    /// Local space of an instance's shape -> world; `time` of the shutter.
    Affine3d local_to_world(uint32_t index, float time) const;
    /// Whether any instance moves while the shutter is open.
    bool has_motion() const;
    /// Whether any surface is diced by the width of rays.
    bool has_levels() const { return has_levels_; }
    /// Whether an instance's facets do.
    bool goes_through_geometry_cache(uint32_t instance) const;
    /// Bounds of everything at all times, world space; empty for an empty scene.
    Box3d bounds() const;
    Box3d bounds(uint32_t instance) const;
    TraceStatistics statistics() const;
    /// Tessellations that this thread's rays had to make so far.
    uint64_t thread_misses() const;

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
    bool has_levels_;
};

}  // namespace rayleaf
