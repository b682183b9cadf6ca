// One shape ready to be traced in its local space: an Embree scene and what turns a candidate into a hit.
//
// Which facets a ray may hit is found in single precision. Each candidate's t is then computed in double from the
// facet's corners, and only that decides: whether it lies in [t_min, t_max], and which of two is nearer, the lower
// facet if they are equal. So results depend neither on the order in which Embree visits nodes nor on how the rays'
// origins round. Of triangles Embree decides which are hit, in single precision, watertight along shared edges; of
// grids it finds all candidates, and double precision decides.
#pragma once

#include "base/maybe.h"
#include "geometry/facet.h"
#include "geometry/shape.h"
#include "rays/hit.h"
#include "rays/packet.h"
#include "splines/limit_normal.h"
#include "tessellation/geometry_cache.h"
#include "tessellation/grid_intersection.h"
#include "tessellation/packet_intersection.h"
#include "trace/embree.h"
#include "trace/local_ray.h"
#include "trace/passed_hits.h"
#include "trace/shape_parts.h"
#include "trace/snug_box.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace rayleaf {

/// A facet of a shape: a triangle of a mesh (`part` is 0), or triangle number `part` of a subpatch's grid.
struct FacetId {
    uint32_t primitive = 0, part = 0;
    bool operator<(const FacetId& other) const {
        return primitive != other.primitive ? primitive < other.primitive : part < other.part;
    }
};

struct ShapeHit {
    FacetId facet;
    FacetHit point;
    // Of grids only, which may be gone when the hit is looked at:
    Vec2d place{0, 0};    ///< in the fine grid: i + fraction, j + fraction
    uint32_t levels = 0;  ///< SubpatchLevels::packed
    SeenBy seen_by = SeenBy::Itself;
    float time = kMiddleTime;  ///< the ray's, of shapes that deform
};

/// What a shape's facets are held in.
enum class FacetKind : uint8_t { Triangles, Grids, FixedGrids, Resident, Strands, EmbreeCurves };

/// The best hit so far of one ray in one shape, and what it takes to find a nearer one.
struct FacetQuery {
    const LocalRay* ray = nullptr;
    ShapeHit* best = nullptr;
    double farthest = 0;  ///< t of the best hit, or the ray's t_max
    bool found = false;
    std::optional<FacetRay> facet_ray;  ///< once there was something to test

    FacetQuery() = default;
    /// The best hit is found in `hit`.
    FacetQuery(const LocalRay& local, ShapeHit& hit) : ray(&local), best(&hit), farthest(local.t_max) {}

    /// Takes the facet if its exact hit is the nearest so far.
    bool offer(const FacetId& facet, const FacetCorners& corners) {
        return take(facet, exact_facet_hit(corners, ray->origin, ray->direction, ray->speed));
    }
    /// The same of a facet that may be hit.
    bool offer_uncertain(const FacetId& facet, const FacetCorners& corners) {
        if (!facet_ray) facet_ray.emplace(ray->origin, ray->direction, ray->start);
        return take(facet, facet_ray->meet(corners));
    }

    /// Takes a hit if it is the nearest so far.
    bool take(const FacetId& facet, const std::optional<FacetHit>& hit) {
        if (!hit || !(hit->t >= ray->t_min && hit->t <= farthest)) return false;
        if (found && hit->t == best->point.t && best->facet < facet) return false;
        best->facet = facet;
        best->point = *hit;
        farthest = hit->t;
        found = true;
        return true;
    }
};

/// A ray that looks for all hits in one shape.
struct PassingQuery {
    const LocalRay* ray;
    uint32_t instance;
    PassedHits* passed;

    /// Whether the ray need not go on.
    bool take(const FacetId& facet, const std::optional<FacetHit>& hit) const {
        return hit && hit->t >= ray->t_min && hit->t <= ray->t_max &&
               passed->add({instance, facet.primitive, facet.part, *hit});
    }
};

/// A query in one shape, as Embree's callbacks find it: the context is the first member.
struct ShapeQuery {
    EmbreeContext context;
    FacetQuery facets;
    GridRay grid_ray;                    ///< set for grids only
    std::optional<LevelChooser> levels;  ///< set where the shape has levels
    const GeometryCache::Reader* reader = nullptr;

    /// The best hit is found in `hit`.
    ShapeQuery(const LocalRay& local, FacetKind kind, const GeometryCache::Reader* cache, ShapeHit& hit)
        : facets(local, hit),
          grid_ray(kind == FacetKind::Triangles ? GridRay() : GridRay(local.float_origin, local.float_direction)),
          reader(cache) {
        initialize(context);
    }
    static ShapeQuery& of(EmbreeContext* context) { return *reinterpret_cast<ShapeQuery*>(context); }
    const LocalRay& ray() const { return *facets.ray; }
    ShapeHit& best() { return *facets.best; }
};

/// Up to sixteen rays in one shape, as Embree's callbacks find them: the context is the first member. Callbacks know
/// them from a single ray by the ray's id.
struct PacketQuery {
    EmbreeContext context;
    Coherence coherence;
    uint32_t lanes = 0;  ///< those that are asked, a bit each
    uint32_t found = 0;  ///< those that hit something
    uint32_t root = 0;   ///< LocalRay's
    RayPacket rays;
    struct Best {
        FacetId facet;
        FacetHit point;
    };
    std::array<Maybe<Best>, kPacketSize> best;  ///< of the lanes that have found something
    OpenFacets open;                            ///< of shapes of blocks
    float times[kPacketSize] = {};              ///< of the shutter; set for shapes that deform

    explicit PacketQuery(Coherence alike) : coherence(alike) { initialize(context); }
    static PacketQuery& of(EmbreeContext* context) { return *reinterpret_cast<PacketQuery*>(context); }

    bool has_found(size_t lane) const { return (found >> lane & 1u) != 0; }
    /// t of the lane's best hit, or its t_max.
    double farthest(size_t lane) const { return has_found(lane) ? best[lane]->point.t : rays.t_max[lane]; }
    /// LocalRay::float_distance of that.
    float float_farthest(size_t lane) const {
        return float_distance_of(farthest(lane), rays.start[lane], rays.speed[lane]);
    }
    /// Takes a hit if it is the nearest so far.
    bool take(size_t lane, const FacetId& facet, const FacetHit& hit) {
        if (!(hit.t >= rays.t_min[lane] && hit.t <= farthest(lane))) return false;
        if (has_found(lane) && hit.t == best[lane]->point.t && best[lane]->facet < facet) return false;
        best[lane].emplace(facet, hit);
        found |= 1u << lane;
        return true;
    }
};

/// Calls `visit` with the number of each bit.
template <typename Visit>
void for_each_lane(uint32_t lanes, const Visit& visit) {
    for (; lanes != 0; lanes &= lanes - 1) visit(static_cast<size_t>(__builtin_ctz(lanes)));
}

/// How often hits on a shape needed a limit normal; of shapes that count that.
NormalCounters normal_counters(const Shape& shape);

class ShapeScene {
  public:
    virtual ~ShapeScene() = default;
    ShapeScene(const ShapeScene&) = delete;
    ShapeScene& operator=(const ShapeScene&) = delete;

    const Shape& shape() const { return *shape_; }
    /// Whether it matters at what time rays meet it.
    bool deforms() const { return deforms_; }
    /// Bounds of everything a ray can hit, local space, padded for float rays; empty for an empty shape.
    const Box3d& box() const { return box_; }
    /// The same along other axes, where that is smaller.
    const SnugBox& snug_box() const { return snug_box_; }
    /// Parts that rays can be asked to meet alone, together all of it; none: it is met as a whole.
    std::span<const ShapePart> parts() const {
        return kind_ == FacetKind::Resident ? std::span(parts_) : std::span<const ShapePart>();
    }
    /// The same of its image.
    Box3d image(const Affine3d& map) const;

    /// Sets `hit` if there is one.
    virtual bool closest(const LocalRay& ray, ShapeHit& hit) const;
    virtual bool occluded(const LocalRay& ray) const;
    /// Whether the shape can be asked by packets.
    bool takes_packets() const {
        return kind_ == FacetKind::Triangles || kind_ == FacetKind::Resident || kind_ == FacetKind::Strands;
    }
    /// The same for a packet, with `found` for each lane. For occluded, any hit will do.
    virtual void find_closest(PacketQuery& packet) const;
    virtual void find_any(PacketQuery& packet) const;

    /// Whether all hits of a ray can be found at once.
    virtual bool finds_all() const { return false; }
    /// Adds them, as those of an instance, until the ray need not go on; whether it need not.
    virtual bool find_all(const LocalRay& /*ray*/, uint32_t /*instance*/, PassedHits& /*passed*/) const {
        return false;
    }

    virtual LocalHit local_hit(const ShapeHit& hit) const = 0;
    /// The hit of a ray of a time.
    LocalHit hit_at(ShapeHit& hit, float time) const {
        hit.time = time;
        LocalHit local = local_hit(hit);
        local.time = time;
        return local;
    }
    /// A point of an element as if a ray had hit its facet there.
    virtual LocalHit on_facet(const LocalHit& hit) const = 0;
    /// How far a float ray may lie beside the true one, local units: coordinates up to 1 are rounded once in its origin
    /// and once against each vertex, on three axes. Less for facets that single precision only finds.
    virtual double float_error() const { return 0x1p-21; }
    /// How far rounding may put a facet's corner beside the surface, local units; 0 where facets are the surface.
    virtual double vertex_error() const { return 0.0; }
    /// How far the finest facets may lie beside the surface, local units; 0 where facets are the surface. Known of
    /// patches, the shapes on which points are found without a facet.
    double facet_distance() const { return facet_distance_; }
    void set_facet_distance(double distance) { facet_distance_ = distance; }
    virtual uint64_t triangle_count() const { return 0; }
    virtual uint64_t strand_pieces() const { return 0; }
    virtual uint32_t subpatch_count() const { return 0; }
    /// Subpatches whose grids the geometry cache holds.
    virtual uint32_t cached_subpatches() const { return 0; }
    /// Bytes of the facets that stay in memory; 0 where there are none.
    virtual uint64_t facet_bytes() const { return 0; }
    /// Bytes of the shape's own tree.
    virtual uint64_t tree_bytes() const { return 0; }
    /// Bytes of what is held beside the trees, the grids and the facets.
    virtual uint64_t record_bytes() const { return 0; }
    /// Whether it matters how wide rays are.
    bool has_levels() const { return kind_ == FacetKind::Grids; }
    virtual NormalCounters limit_normals() const { return {}; }
    /// Where grids are kept, and the number of the first subpatch there; before any ray, for shapes that have
    /// subpatches.
    void set_geometry_cache(const GeometryCache& cache, uint32_t first_subpatch) {
        geometry_cache_ = &cache;
        first_subpatch_ = first_subpatch;
    }

  protected:
    ShapeScene(const Shape& shape, FacetKind kind) : shape_(&shape), kind_(kind), deforms_(shape.deforms()) {}
    /// Embree's scene of the facets; the box is that of the facets, not yet padded.
    void set_scene(EmbreeScene scene, const Box3f& box);
    /// The same of a shape that has a tree of its own.
    void set_box(const Box3f& box);
    /// After the box: points, at all times, between which all facets lie. Shapes of more points keep the box: what is
    /// instanced in great numbers has few, and each is looked at a dozen times.
    static constexpr size_t kMostPoints = 1 << 12;
    void set_points(std::span<const Vec3d> points);
    /// Parts whose boxes together hold what that box holds, not yet padded.
    void set_parts(std::vector<ShapePart> parts);
    RTCScene embree_scene() const { return scene_.get(); }
    const GeometryCache* geometry_cache() const { return geometry_cache_; }
    uint32_t first_subpatch() const { return first_subpatch_; }
    /// As Embree is asked: its kernels for coherent packets round edges of triangles otherwise than those of single
    /// rays, and may name another facet.
    Coherence coherence(const PacketQuery& packet) const;
    /// Before a query of grids.
    virtual void prepare(ShapeQuery&) const {}

  private:
    double facet_distance_ = 0;
    const Shape* shape_;
    FacetKind kind_;
    bool deforms_;
    const GeometryCache* geometry_cache_ = nullptr;
    uint32_t first_subpatch_ = 0;
    EmbreeScene scene_;
    Box3d box_;
    SnugBox snug_box_{Box3d()};
    std::vector<ShapePart> parts_;  ///< none: the box is all that is known
};

}  // namespace rayleaf
