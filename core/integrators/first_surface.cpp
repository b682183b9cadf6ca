#include "integrators/first_surface.h"

namespace rayleaf {

void write_surface(const Scene& scene, const Vertex& vertex, PixelSample& sample) {
    const SurfacePoint& point = vertex.point;
    if (sample.has(Pass::depth)) sample[Pass::depth].x = static_cast<float>(scene.camera().depth(point.position));
    const Vec3f position(point.position);
    sample[Pass::position] = Vec4f(position.x, position.y, position.z, 0.0f);
    const Vec3f normal = point.normal.dot(vertex.outgoing) < 0.0f ? -point.normal : point.normal;
    sample[Pass::normal] = Vec4f(normal.x, normal.y, normal.z, 0.0f);
    if (const MotionVectors* vectors = scene.motion_vectors()) sample[Pass::vector] = vectors->at(point);
    sample[Pass::uv] = Vec4f(point.uv.x, point.uv.y, 1.0f, 0.0f);
    sample[Pass::object_index].x = scene.object_index(point.instance);
    if (sample.has(Pass::material_index))
        sample[Pass::material_index].x = scene.material(point.instance, point.local).pass_index;
}

void write_mist(const Scene& scene, const PathSettings& settings, const Vertex& vertex, const Color& throughput,
                PixelSample& sample) {
    const double way = scene.camera().distance(vertex.point.position) - settings.mist_start;
    // Mist of no depth is a wall.
    const double depth = settings.mist_depth > 0.0 ? std::clamp(way / settings.mist_depth, 0.0, 1.0) : way > 0.0;
    const float mist = std::pow(static_cast<float>(depth), settings.mist_falloff);
    sample[Pass::mist].x += (1.0f - mist) * average(throughput * (Color(1.0f) - vertex.closures.unscattered()));
}

void write_matte(const Scene& scene, const Vertex& vertex, const Color& throughput, PixelSample& sample) {
    if (!sample.extras) return;
    const uint32_t weight = matte_weight(average(throughput) * (1.0f - average(vertex.closures.unscattered())));
    if (weight > 0) sample.extras->mattes.push_back({scene.matte_ids(vertex.point), weight});
}

ByKind albedo_by_kind(const Vertex& vertex, const Color& throughput) {
    ByKind albedo;
    for (const LobeKind kind : kLobeKinds) albedo[kind] = throughput * vertex.closures.albedo(vertex.outgoing, kind);
    return albedo;
}

}  // namespace rayleaf
