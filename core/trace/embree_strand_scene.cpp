#include "trace/embree_strand_scene.h"

#include <algorithm>

namespace rayleaf {
namespace {

/// Smaller numbers become 0: Embree scales the boxes of its curves by one over their size, and ends the process where
/// that is infinite.
float without_tiny(double value) {
    constexpr double kTiny = 1e-15;  // of a shape of size 1
    return std::abs(value) < kTiny ? 0.0f : static_cast<float>(value);
}

}  // namespace

EmbreeStrandScene::EmbreeStrandScene(const Strands& strands, const CancelToken& cancel)
    : ShapeScene(strands, FacetKind::EmbreeCurves), strands_(&strands) {
    const uint32_t count = strands.element_count();
    if (count == 0) return;
    RTCGeometry geometry = rtcNewGeometry(embree_device(), RTC_GEOMETRY_TYPE_ROUND_BEZIER_CURVE);
    constexpr size_t kPoints = 4;
    const size_t steps = strands.steps();
    rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(steps));
    for (size_t step = 0; step < steps; ++step) {
        auto* points = new_embree_buffer<Vec4f>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, kPoints * count,
                                                static_cast<unsigned>(step));
        const float time = steps > 1 ? time_of_step(step, steps) : kMiddleTime;
        for (uint32_t i = 0; i < count; ++i)
            for (const StrandPoint& p : strands.segment(i, time).points)
                *points++ = Vec4f(without_tiny(p.x), without_tiny(p.y), without_tiny(p.z), without_tiny(p.w));
    }
    auto* indices = new_embree_buffer<uint32_t>(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT, count);
    for (uint32_t i = 0; i < count; ++i) indices[i] = kPoints * i;
    EmbreeScene scene = new_embree_scene(cancel);
    build_embree_scene(scene, geometry);
    set_scene(std::move(scene), strands.bounds());
}

bool EmbreeStrandScene::closest(const LocalRay& ray, ShapeHit& hit) const {
    EmbreeContext context;
    initialize(context);
    RTCRayHit found = ray.embree_ray_hit();
    // No double precision decides about hits before the true start, so the ray begins there.
    found.ray.tnear = std::max(0.0f, static_cast<float>((ray.t_min - ray.start) * ray.speed));
    embree_closest(embree_scene(), context, found);
    if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    hit.facet = {found.hit.primID, 0};
    hit.point.t = std::clamp(ray.start + double{found.ray.tfar} / ray.speed, ray.t_min, ray.t_max);
    hit.point.u = found.hit.u;
    hit.point.position = ray.origin + ray.direction * hit.point.t;
    hit.point.normal = normalized_or(Vec3d(found.hit.Ng_x, found.hit.Ng_y, found.hit.Ng_z), Vec3d(0, 0, 1));
    return true;
}

bool EmbreeStrandScene::occluded(const LocalRay& ray) const {
    EmbreeContext context;
    initialize(context);
    RTCRay embree_ray = ray.embree_ray();
    embree_ray.tnear = std::max(0.0f, static_cast<float>((ray.t_min - ray.start) * ray.speed));
    embree_any(embree_scene(), context, embree_ray);
    return embree_ray.tfar < 0.0f;
}

LocalHit EmbreeStrandScene::local_hit(const ShapeHit& hit) const {
    LocalHit local;
    const double s = std::clamp(hit.point.u, 0.0, 1.0);
    local.primitive = hit.facet.primitive;
    local.u = static_cast<float>(s);
    local.position = hit.point.position;
    local.normal = Vec3f(hit.point.normal);
    const Vec3d along = axis_point(strands_->segment(local.primitive, hit.time).derivative(s));
    local.v = wall_angle(normalized_or(along, Vec3d(0, 0, 1)), hit.point.normal);
    return local;
}

}  // namespace rayleaf
