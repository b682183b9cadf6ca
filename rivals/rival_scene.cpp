#include "rivals/rival_scene.h"

#include "base/error.h"
#include "splines/bounds.h"
#include "tessellation/grid.h"

namespace rayleaf {
namespace {

constexpr uint32_t kParts = kNewtonBoxes * kNewtonBoxes;
/// Error of boxes and facets in single precision, scene units.
constexpr float kBoxSlack = 4e-6f;

BezierPatch bicubic_of(const PatchSurface& surface, uint32_t index) {
    const PatchView view = surface.patch(index);
    if (view.rational || view.degree_u > 3 || view.degree_v > 3)
        throw InputError(surface.name(), "splines", "a rational one or one of a degree above 3",
                         "polynomial splines of degree 3 at most");
    BezierPatch patch = BezierPatch::copy_of(view);
    while (patch.degree_u < 3) patch = patch.elevated(PatchDirection::U);
    while (patch.degree_v < 3) patch = patch.elevated(PatchDirection::V);
    return patch;
}

Box3f part_box(const BicubicPatch& patch, uint32_t part) {
    BezierPatch exact{3, 3, false, {}};
    for (const auto& p : patch.points) exact.points.emplace_back(p[0], p[1], p[2], 1.0);
    constexpr double step = 1.0 / kNewtonBoxes;
    const double u = part % kNewtonBoxes * step, v = part / kNewtonBoxes * step;
    Box3f box = outward_float(hull_bounds(exact.restricted(u, u + step, v, v + step).view()));
    box.min -= Vec3f(kBoxSlack);
    box.max += Vec3f(kBoxSlack);
    return box;
}

struct NewtonQuery {
    EmbreeContext context;
    const RivalRay* ray;
    RayPlanes planes;
    BicubicPoint nearest;
};

void set_ray(const RivalRay& ray, RTCRay& out) {
    out.org_x = ray.origin.x;
    out.org_y = ray.origin.y;
    out.org_z = ray.origin.z;
    out.dir_x = ray.direction.x;
    out.dir_y = ray.direction.y;
    out.dir_z = ray.direction.z;
    out.tnear = ray.t_min;
    out.tfar = std::numeric_limits<float>::infinity();
    out.time = 0.0f;
    out.mask = ~0u;
    out.flags = 0;
}

}  // namespace

Vec3f grid_vertex(const BicubicPatch& patch, int i, int j) {
    constexpr float step = 1.0f / kGridCells;
    return evaluate(patch, static_cast<float>(i) * step, static_cast<float>(j) * step).position;
}

RivalScene::RivalScene(std::span<const std::shared_ptr<const PatchSurface>> surfaces, RivalMethod method)
    : method_(method) {
    Box3d box;
    for (const auto& surface : surfaces) box.extendBy(surface->object_bounds());
    frame_ = LocalFrame::fitting(box);
    for (size_t i = 0; i < surfaces.size(); ++i) add_patches(*surfaces[i], static_cast<uint32_t>(i));
    const uint64_t before = embree_bytes();
    scene_ = EmbreeScene(rtcNewScene(embree_device()));
    rtcSetSceneBuildQuality(scene_.get(), RTC_BUILD_QUALITY_HIGH);
    build_embree_scene(scene_, method == RivalMethod::Triangles ? triangles() : newton_boxes());
    bytes_ = embree_bytes() - before + patches_.size() * sizeof(BicubicPatch);
}

void RivalScene::add_patches(const PatchSurface& surface, uint32_t index) {
    const LocalFrame& local = surface.frame();
    for (uint32_t i = 0; i < surface.element_count(); ++i) {
        const BezierPatch patch = bicubic_of(surface, i);
        BicubicPatch& made = patches_.emplace_back();
        for (size_t k = 0; k < patch.points.size(); ++k) {
            const Vec3d point(patch.points[k].x, patch.points[k].y, patch.points[k].z);
            const Vec3f placed = frame_.to_local(point * local.scale + local.center);
            for (int c = 0; c < 3; ++c) made.points[k][c] = placed[c];
        }
        surface_of_.push_back(index);
    }
}

RTCGeometry RivalScene::triangles() const {
    const auto count = static_cast<uint32_t>(patches_.size());
    RTCGeometry geometry = rtcNewGeometry(embree_device(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices =
        new_embree_buffer<Vec3f>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, size_t{count} * kGridSize);
    auto* indices = new_embree_buffer<std::array<uint32_t, 3>>(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3,
                                                               size_t{count} * kGridTriangles)
                        ->data();
    for (uint32_t patch = 0; patch < count; ++patch) {
        for (int k = 0; k < kGridSize; ++k)
            *vertices++ = grid_vertex(patches_[patch], k % kGridVertices, k / kGridVertices);
        for (int j = 0; j < kGridCells; ++j) {
            for (int i = 0; i < kGridCells; ++i) {
                const uint32_t a = patch * kGridSize + j * kGridVertices + i, c = a + kGridVertices + 1;
                const uint32_t corners[6] = {a, c, a + 1, a, c - 1, c};
                indices = std::copy_n(corners, 6, indices);
            }
        }
    }
    return geometry;
}

RTCGeometry RivalScene::newton_boxes() {
    for (const BicubicPatch& patch : patches_) {
        for (uint32_t part = 0; part < kParts; ++part) boxes_.push_back(part_box(patch, part));
    }
    return new_user_geometry(this, boxes_.size(), {bounds_callback, newton_callback, nullptr});
}

void RivalScene::bounds_callback(const RTCBoundsFunctionArguments* arguments) {
    const auto& self = *static_cast<const RivalScene*>(arguments->geometryUserPtr);
    const Box3f& box = self.boxes_[arguments->primID];
    *arguments->bounds_o = {box.min.x, box.min.y, box.min.z, 0.0f, box.max.x, box.max.y, box.max.z, 0.0f};
}

RayPlanes::RayPlanes(const RivalRay& ray) {
    orthonormal_basis(ray.direction, normal1, normal2);
    offset1 = normal1.dot(ray.origin);
    offset2 = normal2.dot(ray.origin);
}

NewtonHit newton_hit(const BicubicPatch& patch, int part, const RivalRay& ray, const RayPlanes& planes) {
    constexpr float half = 0.5f / kNewtonBoxes;
    const float middle_u = (2 * (part % kNewtonBoxes) + 1) * half, middle_v = (2 * (part / kNewtonBoxes) + 1) * half;
    NewtonHit hit;
    hit.u = middle_u;
    hit.v = middle_v;
    float last = std::numeric_limits<float>::infinity();
    for (hit.steps = 1; hit.steps <= kMostNewtonSteps; ++hit.steps) {
        const BicubicPoint point = evaluate(patch, hit.u, hit.v);
        const float f1 = planes.normal1.dot(point.position) - planes.offset1;
        const float f2 = planes.normal2.dot(point.position) - planes.offset2;
        const float distance = std::abs(f1) + std::abs(f2);
        if (distance < kNewtonTolerance) {
            hit.point = point;
            hit.t = (point.position - ray.origin).dot(ray.direction);
            hit.found = hit.u >= 0.0f && hit.u <= 1.0f && hit.v >= 0.0f && hit.v <= 1.0f && hit.t > ray.t_min;
            return hit;
        }
        if (distance > 2.0f * last) return hit;  // it does not converge
        last = distance;
        const float a = planes.normal1.dot(point.du), b = planes.normal1.dot(point.dv);
        const float c = planes.normal2.dot(point.du), d = planes.normal2.dot(point.dv);
        const float determinant = a * d - b * c;
        if (determinant == 0.0f) return hit;
        hit.u -= (d * f1 - b * f2) / determinant;
        hit.v -= (a * f2 - c * f1) / determinant;
        const bool near =
            std::abs(hit.u - middle_u) <= half + kNewtonSlack && std::abs(hit.v - middle_v) <= half + kNewtonSlack;
        if (!near) return hit;
    }
    return hit;
}

void RivalScene::newton_callback(const RTCIntersectFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) return;
    const auto& self = *static_cast<const RivalScene*>(arguments->geometryUserPtr);
    NewtonQuery& query = *reinterpret_cast<NewtonQuery*>(arguments->context);
    RTCRayN* ray = RTCRayHitN_RayN(arguments->rayhit, arguments->N);
    RTCHitN* found = RTCRayHitN_HitN(arguments->rayhit, arguments->N);
    const uint32_t patch = arguments->primID / kParts;
    const NewtonHit hit =
        newton_hit(self.patches_[patch], static_cast<int>(arguments->primID % kParts), *query.ray, query.planes);
    if (!hit.found || hit.t >= RTCRayN_tfar(ray, arguments->N, 0)) return;
    query.nearest = hit.point;
    RTCRayN_tfar(ray, arguments->N, 0) = hit.t;
    RTCHitN_primID(found, arguments->N, 0) = patch;
    RTCHitN_geomID(found, arguments->N, 0) = arguments->geomID;
}

RivalHit RivalScene::on_patch(uint32_t patch, const BicubicPoint& point, float t) const {
    const Vec3f across = point.dv.cross(point.du);
    const float square = across.dot(across);
    RivalHit hit;
    hit.t = t;
    hit.surface = surface_of_[patch];
    hit.position = hit.facet_position = point.position;
    if (square > 0.0f) hit.normal = across * (1.0f / std::sqrt(square));
    hit.facet_normal = hit.normal;
    return hit;
}

RivalHit RivalScene::on_triangle(const RivalRay& ray, const FoundTriangle& found) const {
    const uint32_t patch = found.triangle / kGridTriangles, triangle = found.triangle % kGridTriangles;
    const uint32_t cell = triangle / 2;
    // Corners: (0,0), (1,1), (1,0), and (0,0), (0,1), (1,1); barycentric weights u of the second, v of the third.
    const float in_u = triangle % 2 == 0 ? found.u + found.v : found.v;
    const float in_v = triangle % 2 == 0 ? found.u : found.u + found.v;
    const float u = (static_cast<float>(cell % kGridCells) + in_u) / kGridCells;
    const float v = (static_cast<float>(cell / kGridCells) + in_v) / kGridCells;
    RivalHit hit = on_patch(patch, evaluate(patches_[patch], u, v), found.t);
    const Vec3f& facet = found.facet_normal;
    hit.facet_normal = facet * ((facet.dot(hit.normal) < 0.0f ? -1.0f : 1.0f) / std::sqrt(facet.dot(facet)));
    hit.facet_position = ray.origin + ray.direction * found.t;
    return hit;
}

bool RivalScene::closest(const RivalRay& ray, RivalHit& hit) const {
    RTCRayHit query;
    set_ray(ray, query.ray);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    if (method_ == RivalMethod::Newton) {
        NewtonQuery newton{{}, &ray, RayPlanes(ray), {}};
        initialize(newton.context);
        embree_closest(scene_.get(), newton.context, query);
        if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
        hit = on_patch(query.hit.primID, newton.nearest, query.ray.tfar);
        return true;
    }
    EmbreeContext context;
    initialize(context);
    embree_closest(scene_.get(), context, query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    const Vec3f facet_normal(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z);
    hit = on_triangle(ray, {query.ray.tfar, query.hit.u, query.hit.v, query.hit.primID, facet_normal});
    return true;
}

void RivalScene::closest16(const std::array<RivalRay, kPacketSize>& rays, std::array<int, kPacketSize>& active,
                           std::array<RivalHit, kPacketSize>& hits) const {
    alignas(64) RTCRayHit16 query;
    alignas(64) int valid[kPacketSize];
    for (int i = 0; i < kPacketSize; ++i) {
        valid[i] = active[i] ? -1 : 0;
        query.ray.org_x[i] = rays[i].origin.x;
        query.ray.org_y[i] = rays[i].origin.y;
        query.ray.org_z[i] = rays[i].origin.z;
        query.ray.dir_x[i] = rays[i].direction.x;
        query.ray.dir_y[i] = rays[i].direction.y;
        query.ray.dir_z[i] = rays[i].direction.z;
        query.ray.tnear[i] = rays[i].t_min;
        query.ray.tfar[i] = (active[i] ? 1.0f : -1.0f) * std::numeric_limits<float>::infinity();
        query.ray.time[i] = 0.0f;
        query.ray.mask[i] = ~0u;
        query.ray.flags[i] = 0;
        query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
    EmbreeContext context;
    initialize(context);
    embree_closest16(valid, scene_.get(), context, Coherence::Coherent, query);
    for (int i = 0; i < kPacketSize; ++i) {
        if (!active[i]) continue;
        active[i] = query.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
        if (!active[i]) continue;
        const Vec3f facet_normal(query.hit.Ng_x[i], query.hit.Ng_y[i], query.hit.Ng_z[i]);
        hits[i] = on_triangle(rays[i],
                              {query.ray.tfar[i], query.hit.u[i], query.hit.v[i], query.hit.primID[i], facet_normal});
    }
}

}  // namespace rayleaf
