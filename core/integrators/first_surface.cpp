#include "integrators/first_surface.h"

namespace rayleaf {

void write_surface(const Scene& scene, const Vertex& vertex, PixelSample& sample) {
    const SurfacePoint& point = vertex.point;
    const Vec3f position(point.position);
    const Vec3f normal = point.normal.dot(vertex.outgoing) < 0.0f ? -point.normal : point.normal;
    sample[Pass::depth].x = static_cast<float>(scene.camera().depth(point.position));
    sample[Pass::position] = Vec4f(position.x, position.y, position.z, 0.0f);
    sample[Pass::normal] = Vec4f(normal.x, normal.y, normal.z, 0.0f);
    sample[Pass::uv] = Vec4f(point.uv.x, point.uv.y, 1.0f, 0.0f);
    sample[Pass::object_index].x = scene.object_index(point.instance);
    sample[Pass::material_index].x = scene.material(point.instance, point.local).pass_index;
}

ByKind albedo_by_kind(const Vertex& vertex, const Color& throughput) {
    ByKind albedo;
    for (const LobeKind kind : kLobeKinds) albedo[kind] = throughput * vertex.closures.albedo(vertex.outgoing, kind);
    return albedo;
}

}  // namespace rayleaf
