#include "trace/triangle_scene.h"

namespace rayleaf {
namespace {

const TriangleMesh& mesh_of(const RTCFilterFunctionNArguments* arguments) {
    return *static_cast<const TriangleMesh*>(arguments->geometryUserPtr);
}

bool offer(const RTCFilterFunctionNArguments* arguments) {
    ShapeQuery& query = ShapeQuery::of(arguments->context);
    const uint32_t triangle = RTCHitN_primID(arguments->hit, arguments->N, 0);
    return query.offer({triangle, 0}, mesh_of(arguments).corners(triangle));
}

void filter_closest(const RTCFilterFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) return;
    if (offer(arguments)) {
        const ShapeQuery& query = ShapeQuery::of(arguments->context);
        RTCRayN_tfar(arguments->ray, arguments->N, 0) = query.ray->float_distance(query.farthest);
    } else {
        arguments->valid[0] = 0;
    }
}

void filter_any(const RTCFilterFunctionNArguments* arguments) {
    if (arguments->valid[0] != 0 && !offer(arguments)) arguments->valid[0] = 0;
}

}  // namespace

TriangleScene::TriangleScene(const TriangleMesh& mesh, const CancelToken& cancel)
    : ShapeScene(mesh, FacetKind::Triangles), mesh_(&mesh) {
    if (mesh.triangles().empty()) return;
    RTCGeometry geometry = rtcNewGeometry(embree_device(), RTC_GEOMETRY_TYPE_TRIANGLE);
    // Embree reads 16 bytes at the last vertex, so it gets a copy of its own with room behind.
    const size_t count = mesh.vertices().size();
    auto* vertices = static_cast<Vec3f*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f), count));
    if (vertices) std::copy(mesh.vertices().begin(), mesh.vertices().end(), vertices);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles().data(), 0,
                               sizeof(mesh.triangles()[0]), mesh.triangles().size());
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
