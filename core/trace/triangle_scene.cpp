#include "trace/triangle_scene.h"

namespace rayleaf {
namespace {

const TriangleMesh& mesh_of(const RTCFilterFunctionNArguments* arguments) {
    return *static_cast<const TriangleMesh*>(arguments->geometryUserPtr);
}

bool offer(const RTCFilterFunctionNArguments* arguments, unsigned lane, FacetQuery& query) {
    const TriangleMesh& mesh = mesh_of(arguments);
    uint32_t triangle = RTCHitN_primID(arguments->hit, arguments->N, lane);
    if (mesh.layout() == FacetLayout::Quads) {
        RTCHitN* hit = arguments->hit;
        const bool is_second = RTCHitN_u(hit, arguments->N, lane) + RTCHitN_v(hit, arguments->N, lane) > 1.0f;
        triangle = 2 * triangle + (is_second ? 1 : 0);
    }
    return query.offer({triangle, 0}, mesh.corners(triangle));
}

/// The query of a lane: of a packet, or of a single ray.
FacetQuery& query_of(const RTCFilterFunctionNArguments* arguments, unsigned lane) {
    return arguments->N == 1 ? ShapeQuery::of(arguments->context).facets
                             : PacketQuery::of(arguments->context).facets[lane];
}

void filter_closest(const RTCFilterFunctionNArguments* arguments) {
    for (unsigned lane = 0; lane < arguments->N; ++lane) {
        if (arguments->valid[lane] == 0) continue;
        FacetQuery& query = query_of(arguments, lane);
        if (offer(arguments, lane, query))
            RTCRayN_tfar(arguments->ray, arguments->N, lane) = query.ray->float_distance(query.farthest);
        else
            arguments->valid[lane] = 0;
    }
}

void filter_any(const RTCFilterFunctionNArguments* arguments) {
    for (unsigned lane = 0; lane < arguments->N; ++lane)
        if (arguments->valid[lane] != 0 && !offer(arguments, lane, query_of(arguments, lane)))
            arguments->valid[lane] = 0;
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

TriangleScene::TriangleScene(const TriangleMesh& mesh, const CancelToken& cancel)
    : ShapeScene(mesh, FacetKind::Triangles), mesh_(&mesh) {
    if (mesh.triangles().empty()) return;
    const bool quads = mesh.layout() == FacetLayout::Quads;
    RTCGeometry geometry = rtcNewGeometry(embree_device(), quads ? RTC_GEOMETRY_TYPE_QUAD : RTC_GEOMETRY_TYPE_TRIANGLE);
    // Embree reads 16 bytes at the last vertex, so it gets a copy of its own with room behind.
    const size_t count = mesh.vertices().size();
    auto* vertices = new_embree_buffer<Vec3f>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, count);
    std::copy(mesh.vertices().begin(), mesh.vertices().end(), vertices);
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
}

LocalHit TriangleScene::local_hit(const ShapeHit& hit) const {
    LocalHit local;
    local.primitive = hit.facet.primitive;
    local.u = static_cast<float>(hit.point.u);
    local.v = static_cast<float>(hit.point.v);
    local.position = hit.point.position;
    const Vec3d area = area_vector(mesh_->corners(hit.facet.primitive));
    local.normal = Vec3f(area / max_abs(area));  // never zero: the facet was hit
    return local;
}

}  // namespace rayleaf
