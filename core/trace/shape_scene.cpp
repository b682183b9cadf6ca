#include "trace/shape_scene.h"

#include "geometry/patch_surface.h"
#include "geometry/subdivision_surface.h"

namespace rayleaf {

NormalCounters normal_counters(const Shape& shape) {
    if (shape.kind() == ShapeKind::SubdivisionSurface)
        return static_cast<const SubdivisionSurface&>(shape).limit_normals();
    if (shape.kind() == ShapeKind::PatchSurface) return static_cast<const PatchSurface&>(shape).limit_normals();
    return {};
}

void ShapeScene::set_scene(EmbreeScene scene, const Box3f& box) {
    scene_ = std::move(scene);
    const Vec3d padding(kBoxPadding);
    box_ = Box3d(Vec3d(box.min) - padding, Vec3d(box.max) + padding);
}

bool ShapeScene::closest(const LocalRay& ray, ShapeHit& hit) const {
    std::optional<GeometryCache::Reader> own;
    if (!ray.reader && geometry_cache_) own.emplace(*geometry_cache_);
    ShapeQuery query(ray, kind_, own ? &*own : ray.reader, hit);
    prepare(query);
    RTCRayHit embree_ray = ray.embree_ray_hit();
    embree_closest(scene_.get(), query.context, embree_ray);
    return query.facets.found;
}

bool ShapeScene::occluded(const LocalRay& ray) const {
    std::optional<GeometryCache::Reader> own;
    if (!ray.reader && geometry_cache_) own.emplace(*geometry_cache_);
    ShapeHit hit;
    ShapeQuery query(ray, kind_, own ? &*own : ray.reader, hit);
    prepare(query);
    RTCRay embree_ray = ray.embree_ray();
    embree_any(scene_.get(), query.context, embree_ray);
    return query.facets.found;
}

namespace {

/// Writes the lanes of a packet as Embree wants them. `valid`: -1 for rays that are asked.
void fill(PacketQuery& packet, bool with_blocks, int* valid, RTCRay16& out) {
    for (int lane = 0; lane < kPacketSize; ++lane) {
        valid[lane] = (packet.lanes >> lane & 1u) != 0 ? -1 : 0;
        if (valid[lane] == 0) continue;
        const LocalRay& ray = *packet.facets[static_cast<size_t>(lane)].ray;
        out.org_x[lane] = ray.float_origin.x;
        out.org_y[lane] = ray.float_origin.y;
        out.org_z[lane] = ray.float_origin.z;
        out.tnear[lane] = 0.0f;
        out.dir_x[lane] = ray.float_direction.x;
        out.dir_y[lane] = ray.float_direction.y;
        out.dir_z[lane] = ray.float_direction.z;
        out.time[lane] = 0.0f;
        out.tfar[lane] = ray.float_distance(ray.t_max);
        out.mask[lane] = ~0u;
        out.id[lane] = static_cast<unsigned>(lane);
        out.flags[lane] = 0;
        if (with_blocks) packet.rays.set(lane, ray.float_origin, ray.float_direction);
    }
}

}  // namespace

void ShapeScene::closest(PacketQuery& packet) const {
    alignas(64) int valid[kPacketSize];
    RTCRayHit16 rays;
    fill(packet, kind_ == FacetKind::Resident, valid, rays.ray);
    for (int lane = 0; lane < kPacketSize; ++lane)
        rays.hit.geomID[lane] = rays.hit.primID[lane] = rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    embree_closest16(valid, scene_.get(), packet.context, packet.coherence, rays);
}

void ShapeScene::occluded(PacketQuery& packet) const {
    alignas(64) int valid[kPacketSize];
    RTCRay16 rays;
    fill(packet, kind_ == FacetKind::Resident, valid, rays);
    embree_any16(valid, scene_.get(), packet.context, packet.coherence, rays);
}

}  // namespace rayleaf
