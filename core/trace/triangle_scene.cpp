#include "trace/triangle_scene.h"

#include "trace/shape_parts.h"

namespace rayleaf {
namespace {

const TriangleMesh& mesh_of(const RTCFilterFunctionNArguments* arguments) {
    return *static_cast<const TriangleMesh*>(arguments->geometryUserPtr);
}

/// The triangle that Embree has found for the ray at a place.
uint32_t triangle_of(const RTCFilterFunctionNArguments* arguments, unsigned place) {
    const uint32_t primitive = RTCHitN_primID(arguments->hit, arguments->N, place);
    if (mesh_of(arguments).layout() != FacetLayout::Quads) return primitive;
    RTCHitN* hit = arguments->hit;
    const bool is_second = RTCHitN_u(hit, arguments->N, place) + RTCHitN_v(hit, arguments->N, place) > 1.0f;
    return 2 * primitive + (is_second ? 1 : 0);
}

/// As Embree's callbacks find it: the context is the first member.
struct PassingRay {
    EmbreeContext context;
    PassingQuery query;

    static PassingRay& of(EmbreeContext* context) { return *reinterpret_cast<PassingRay*>(context); }
    bool offer(uint32_t triangle, const FacetCorners& corners) const {
        const LocalRay& ray = *query.ray;
        return query.take({triangle, 0}, exact_facet_hit(corners, ray.origin, ray.direction, ray.speed));
    }
};

/// Of a single ray or of a packet's: whether the hit is the nearest so far.
bool offer(const RTCFilterFunctionNArguments* arguments, unsigned place) {
    const uint32_t triangle = triangle_of(arguments, place);
    const FacetCorners corners =
        mesh_of(arguments).corners(triangle, RTCRayN_time(arguments->ray, arguments->N, place));
    const uint32_t lane = RTCRayN_id(arguments->ray, arguments->N, place);
    if (lane == kRayPassing) return PassingRay::of(arguments->context).offer(triangle, corners);
    if (lane == kRayAlone) return ShapeQuery::of(arguments->context).facets.offer({triangle, 0}, corners);
    PacketQuery& packet = PacketQuery::of(arguments->context);
    const RayPacket& rays = packet.rays;
    const std::optional<FacetHit> hit =
        exact_facet_hit(corners, rays.origin_of(lane), rays.direction_of(lane), rays.speed[lane]);
    return hit && packet.take(lane, {triangle, 0}, *hit);
}

float farthest(const RTCFilterFunctionNArguments* arguments, unsigned place) {
    const uint32_t lane = RTCRayN_id(arguments->ray, arguments->N, place);
    if (lane != kRayAlone) return PacketQuery::of(arguments->context).float_farthest(lane);
    const FacetQuery& query = ShapeQuery::of(arguments->context).facets;
    return query.ray->float_distance(query.farthest);
}

void filter_closest(const RTCFilterFunctionNArguments* arguments) {
    for (unsigned place = 0; place < arguments->N; ++place) {
        if (arguments->valid[place] == 0) continue;
        if (offer(arguments, place))
            RTCRayN_tfar(arguments->ray, arguments->N, place) = farthest(arguments, place);
        else
            arguments->valid[place] = 0;
    }
}

void filter_any(const RTCFilterFunctionNArguments* arguments) {
    for (unsigned place = 0; place < arguments->N; ++place)
        if (arguments->valid[place] != 0 && !offer(arguments, place)) arguments->valid[place] = 0;
}

void set_triangles(RTCGeometry geometry, const TriangleMesh& mesh) {
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles().data(), 0,
                               sizeof(mesh.triangles()[0]), mesh.triangles().size());
}

/// Embree splits a quadrangle as the mesh does.
void set_quads(RTCGeometry geometry, const TriangleMesh& mesh) {
    const size_t count = mesh.triangles().size() / 2;
    auto* quads = new_embree_buffer<std::array<uint32_t, 4>>(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT4, count);
    for (size_t i = 0; i < count; ++i) {
        const std::array<uint32_t, 3>&first = mesh.triangles()[2 * i], &second = mesh.triangles()[2 * i + 1];
        const bool first_is_point = first[0] == first[1] && first[1] == first[2];
        if (first_is_point)
            quads[i] = {first[0], second[2], second[0], second[1]};
        else
            quads[i] = {first[0], first[1], second[0], first[2]};
    }
}

}  // namespace

TriangleScene::TriangleScene(const TriangleMesh& mesh, const CancelToken& cancel) : MeshScene(mesh) {
    if (mesh.triangles().empty()) return;
    const bool quads = mesh.layout() == FacetLayout::Quads;
    RTCGeometry geometry = rtcNewGeometry(embree_device(), quads ? RTC_GEOMETRY_TYPE_QUAD : RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(mesh.steps()));
    for (size_t step = 0; step < mesh.steps(); ++step) {
        // Embree reads 16 bytes at the last vertex, so it gets a copy of its own with room behind.
        const std::span<const Vec3f> from = mesh.vertices(step);
        auto* vertices = new_embree_buffer<Vec3f>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, from.size(),
                                                  static_cast<unsigned>(step));
        std::copy(from.begin(), from.end(), vertices);
    }
    if (quads)
        set_quads(geometry, mesh);
    else
        set_triangles(geometry, mesh);
    rtcSetGeometryUserData(geometry, const_cast<TriangleMesh*>(&mesh));
    rtcSetGeometryIntersectFilterFunction(geometry, filter_closest);
    rtcSetGeometryOccludedFilterFunction(geometry, filter_any);
    EmbreeScene scene = new_embree_scene(cancel);
    build_embree_scene(scene, geometry);
    set_scene(std::move(scene), mesh.bounds());
    set_parts_and_points();
}

bool TriangleScene::find_all(const LocalRay& ray, uint32_t instance, PassedHits& passed) const {
    PassingRay passing{{}, {&ray, instance, &passed}};
    initialize(passing.context);
    RTCRay embree_ray = ray.embree_ray();
    embree_ray.id = kRayPassing;
    embree_any(embree_scene(), passing.context, embree_ray);
    return passed.is_closed();
}

bool FewTrianglesScene::suits(const TriangleMesh& mesh) {
    constexpr size_t kMost = 12;  // a box
    return !mesh.deforms() && !mesh.triangles().empty() && mesh.triangles().size() <= kMost;
}

FewTrianglesScene::FewTrianglesScene(const TriangleMesh& mesh) : MeshScene(mesh), meet_few_(few_facets_kernel()) {
    for (uint32_t i = 0; i < mesh.triangles().size(); ++i) corners_.push_back(mesh.corners(i));
    set_box(mesh.bounds());
    set_parts_and_points();
}

bool FewTrianglesScene::closest(const LocalRay& ray, ShapeHit& hit) const {
    FacetQuery query(ray, hit);
    const FacetRay facet_ray(ray.origin, ray.direction, ray.start);
    for (uint32_t i = 0; i < corners_.size(); ++i) query.take({i, 0}, facet_ray.meet(corners_[i]));
    return query.found;
}

bool FewTrianglesScene::occluded(const LocalRay& ray) const {
    ShapeHit hit;
    FacetQuery query(ray, hit);
    const FacetRay facet_ray(ray.origin, ray.direction, ray.start);
    for (uint32_t i = 0; i < corners_.size() && !query.found; ++i) query.take({i, 0}, facet_ray.meet(corners_[i]));
    return query.found;
}

void FewTrianglesScene::find_closest(PacketQuery& packet) const {
    packet.found = 0;
    NearestFacets nearest;
    for_each_lane(meet_few_.closest(packet.rays, packet.lanes, corners_, nearest), [&](size_t lane) {
        packet.take(lane, {static_cast<uint32_t>(nearest.number[lane]), 0}, nearest.hits.hit(lane));
    });
}

void FewTrianglesScene::find_any(PacketQuery& packet) const {
    packet.found = meet_few_.any(packet.rays, packet.lanes, corners_);
}

bool FewTrianglesScene::find_all(const LocalRay& ray, uint32_t instance, PassedHits& passed) const {
    const FacetRay facet_ray(ray.origin, ray.direction, ray.start);
    const PassingQuery query{&ray, instance, &passed};
    for (uint32_t i = 0; i < corners_.size(); ++i)
        if (query.take({i, 0}, facet_ray.meet(corners_[i]))) return true;
    return false;
}

void MeshScene::set_parts_and_points() {
    set_parts(parts_of(*mesh_));
    std::vector<Vec3d> points;
    if (mesh_->vertices(0).size() * mesh_->steps() > kMostPoints) return;
    for (size_t step = 0; step < mesh_->steps(); ++step)
        for (const Vec3f& vertex : mesh_->vertices(step)) points.emplace_back(vertex);
    set_points(points);
}

LocalHit MeshScene::local_hit(const ShapeHit& hit) const {
    LocalHit local;
    local.primitive = hit.facet.primitive;
    local.u = static_cast<float>(hit.point.u);
    local.v = static_cast<float>(hit.point.v);
    local.position = hit.point.position;
    local.normal = Vec3f(hit.point.normal / max_abs(hit.point.normal));  // never zero: the facet was hit
    return local;
}

LocalHit MeshScene::on_facet(const LocalHit& hit) const {
    return deforms() ? mesh_->point_at(hit) : hit;
}

}  // namespace rayleaf
