#include "trace/shape_scene.h"

#include "geometry/patch_surface.h"
#include "geometry/subdivision_surface.h"
#include "trace/shape_parts.h"

#include <algorithm>
#include <limits>

namespace rayleaf {

NormalCounters normal_counters(const Shape& shape) {
    if (shape.kind() == ShapeKind::SubdivisionSurface)
        return static_cast<const SubdivisionSurface&>(shape).limit_normals();
    if (shape.kind() == ShapeKind::PatchSurface) return static_cast<const PatchSurface&>(shape).limit_normals();
    return {};
}

void ShapeScene::set_scene(EmbreeScene scene, const Box3f& box) {
    scene_ = std::move(scene);
    set_box(box);
}

void ShapeScene::set_box(const Box3f& box) {
    const Vec3d padding(kBoxPadding);
    box_ = Box3d(Vec3d(box.min) - padding, Vec3d(box.max) + padding);
    snug_box_ = SnugBox(box_);
}

void ShapeScene::set_points(std::span<const Vec3d> points) {
    snug_box_ = SnugBox(box_, points);
}

void ShapeScene::set_parts(std::vector<ShapePart> parts) {
    parts_ = std::move(parts);
    const Vec3d padding(kBoxPadding);
    for (ShapePart& part : parts_) part.box = Box3d(part.box.min - padding, part.box.max + padding);
}

Box3d ShapeScene::image(const Affine3d& map) const {
    Box3d box = image_of(box_, map);
    Box3d of_parts;
    for (const ShapePart& part : parts_) of_parts.extendBy(image_of(part.box, map));
    if (box.isEmpty() || of_parts.isEmpty()) return box;
    for (int axis = 0; axis < 3; ++axis) {
        box.min[axis] = std::max(box.min[axis], of_parts.min[axis]);
        box.max[axis] = std::min(box.max[axis], of_parts.max[axis]);
    }
    return box;
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

/// Writes the lanes of a packet as Embree wants them. `valid`: -1 for rays that are asked. Others end before they
/// begin: where Embree takes packets apart it looks at that alone.
void fill(const PacketQuery& packet, bool has_times, int* valid, RTCRay16& out) {
    const RayPacket& rays = packet.rays;
    for (uint32_t lane = 0; lane < kPacketSize; ++lane) valid[lane] = -static_cast<int>(packet.lanes >> lane & 1u);
    const auto copy = [](const float(&from)[kPacketSize], float* to) { std::copy_n(from, kPacketSize, to); };
    copy(rays.near_origin[0], out.org_x);
    copy(rays.near_origin[1], out.org_y);
    copy(rays.near_origin[2], out.org_z);
    copy(rays.unit_direction[0], out.dir_x);
    copy(rays.unit_direction[1], out.dir_y);
    copy(rays.unit_direction[2], out.dir_z);
    for (uint32_t lane = 0; lane < kPacketSize; ++lane) {
        out.tfar[lane] = valid[lane] ? rays.farthest[lane] : -std::numeric_limits<float>::infinity();
        out.id[lane] = lane;
    }
    std::fill_n(out.tnear, kPacketSize, 0.0f);
    if (has_times)
        std::copy_n(packet.times, kPacketSize, out.time);
    else
        std::fill_n(out.time, kPacketSize, 0.0f);
    std::fill_n(out.mask, kPacketSize, ~0u);
    std::fill_n(out.flags, kPacketSize, 0u);
}

}  // namespace

Coherence ShapeScene::coherence(const PacketQuery& packet) const {
    return kind_ == FacetKind::Triangles ? Coherence::Incoherent : packet.coherence;
}

void ShapeScene::find_closest(PacketQuery& packet) const {
    packet.found = 0;
    RTCRayHit16 result;
    alignas(64) int valid[kPacketSize];
    fill(packet, deforms_, valid, result.ray);
    std::fill_n(result.hit.geomID, kPacketSize, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(result.hit.primID, kPacketSize, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(result.hit.instID[0], kPacketSize, RTC_INVALID_GEOMETRY_ID);
    embree_closest16(valid, scene_.get(), packet.context, coherence(packet), result);
}

void ShapeScene::find_any(PacketQuery& packet) const {
    packet.found = 0;
    RTCRay16 result;
    alignas(64) int valid[kPacketSize];
    fill(packet, deforms_, valid, result);
    embree_any16(valid, scene_.get(), packet.context, coherence(packet), result);
}

}  // namespace rayleaf
