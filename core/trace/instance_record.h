// One instance as queries need it: from world to the shape's local space and back, its ray cache, its traced shape.
#pragma once

#include "geometry/surface_point.h"
#include "rays/hit.h"
#include "rays/ray.h"
#include "trace/clipped_packet.h"
#include "trace/local_ray.h"
#include "trace/local_ray_cache.h"
#include "trace/shape_scene.h"

#include <memory>

namespace rayleaf {

/// What most rays read comes first and fills two lines of the processor's caches.
struct alignas(64) InstanceRecord {
    const ShapeScene* scene = nullptr;
    const LocalRayCache* cache = nullptr;  ///< null: rays are traced
    const Motion* motion = nullptr;        ///< null: it stands still, else the maps are those of one moment
    uint64_t visibility = 0;               ///< TracedInstance's
    RayMap to_local;                       ///< world -> local
    Affine3d local_to_world;

    /// A local length looks at most 1 / `shrink` times as long in the world; a world length along a ray is at least
    /// `widening / shrink` times its local one.
    float shrink = 1, widening = 1;

    // Of the map, for each hit:
    Vec3d normal_x{1, 0, 0}, normal_y{0, 1, 0}, normal_z{0, 0, 1};  ///< images of normals, turned outwards; not unit
    double longest = 1;                                             ///< what a local unit becomes at most
    double sum_of_lengths = 3;                                      ///< of the axes' images
    double shear = 3;                                               ///< see start_offset()

    /// Sets the maps. Throws InputError if they are singular.
    void place(const Shape& shape, const Affine3d& object_to_world);
    /// The same; false if they are singular.
    bool try_place(const Shape& shape, const Affine3d& object_to_world);
    /// The record as rays of a time meet it, in `room` where the instance moves; null while it is flat, and nothing can
    /// meet it.
    const InstanceRecord* at(float time, Maybe<InstanceRecord>& room) const {
        return motion ? moved(time, room) : this;
    }

    /// How far one number may be rounded beside another of size 1, times the operations on the way (start_offset).
    static constexpr double kRoundingUnit = 64 * 0x1p-53;

    Vec3d vector_to_local(const Vec3d& v) const { return to_local.x * v.x + to_local.y * v.y + to_local.z * v.z; }
    /// The translation is subtracted first: that rounds nothing where it matters, close to a far object.
    Vec3d point_to_local(const Vec3d& p) const { return vector_to_local(p - to_local.translation); }
    Vec3d normal_to_world(const Vec3d& n) const { return normal_x * n.x + normal_y * n.y + normal_z * n.z; }
    /// Of the whole motion.
    Box3d world_box() const;

    /// How far from a facet a ray must start so that rounding cannot put it on the other side, world units. `size` is
    /// the largest number that went into the computation of the hit: coordinates of the ray, world units.
    double start_offset(const Vec3d& position, const Vec3d& normal, double size) const;

    LocalSurface local_surface(const LocalHit& hit, SurfaceDetail detail) const {
        const Shape& shape = scene->shape();
        return detail == SurfaceDetail::Curvature ? shape.surface(hit) : shape.surface_without_curvature(hit);
    }
    /// Where a hit on a facet lies in world space, and nothing that only shading needs; `size` as above, `index` the
    /// instance's. `position` and `normal` are the facet's.
    SurfacePoint facet_point(uint32_t index, const LocalHit& hit, double size) const;
    /// Everything about a hit in world space.
    SurfacePoint surface_point(uint32_t index, const LocalHit& hit, double size, const InterpolatedHit* interpolated,
                               SurfaceDetail detail) const;

    /// The cache's answer to a world ray from its t_min on; `ray` is the same, clipped. `differential`, the world
    /// ray's, may be null.
    ObjectAnswer ask(const Ray& world_ray, const LocalRay& ray, const RayDifferential* differential) const;
    RayDifferential local_differential(const Ray& world_ray, const LocalRay& ray,
                                       const RayDifferential& differential) const;
    /// An interpolated answer as a hit at `t` of a world ray.
    LocalHit interpolated_local(const Ray& world_ray, double t, const ObjectAnswer& answer) const;

    void set_curvature(const LocalSurface& local, SurfacePoint& point) const;
    RayBeam local_beam(const RayBeam& beam) const;
    /// A world ray up to t_max in local space; empty where it misses
    /// the shape's box. `index` is the instance's.
    Maybe<LocalRay> local_ray(uint32_t index, const Ray& world_ray, double t_max) const;

    /// By tracing alone; `index` is the instance's.
    Maybe<Hit> closest(uint32_t index, const Ray& world_ray) const;
    LengthAnswer length_inside(const Ray& world_ray) const;

  private:
    const InstanceRecord* moved(float time, Maybe<InstanceRecord>& room) const;
};

}  // namespace rayleaf
