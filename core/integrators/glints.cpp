#include "integrators/glints.h"

#include "scene/scene.h"
#include "shading/lobes.h"

namespace rayleaf {
namespace {

/// The most often that a mirror direction is sampled, in multiples of its share.
constexpr float kMostGlint = 16.0f;

/// Whether sampling may leave out the mirror direction of a singular lobe, and lights may be seen in it: from within
/// glass, its other side is.
bool is_mirror_by_chance(const Lobe& lobe, const Closures& closures) {
    if (!is_singular(lobe)) return false;
    const bool alone = closures.size() == 1 && is_black(closures.unscattered());
    return (lobe.type == LobeType::Glass && lobe.ior > 1.0f) || (lobe.type == LobeType::Reflection && !alone);
}

constexpr float kWhite = 1.0f;  ///< of a display

/// How bright the light is that the lobe mirrors, against white: what is no brighter makes little noise.
float glint(const Scene& scene, const Bounces& bounces, const Vertex& vertex, const Lobe& lobe, RayCounts& counts) {
    const Vec3f& facet = vertex.point.facet_normal;
    const float cosine = lobe.normal.dot(vertex.outgoing);
    const Vec3f direction = lobe.normal * (2.0f * cosine) - vertex.outgoing;
    if (!(cosine > 0.0f) || !(facet.dot(direction) * facet.dot(vertex.outgoing) > 0.0f)) return 1.0f;
    Ray ray;
    vertex.point.release(ray, ray_direction(direction));
    const std::optional<float> brightness =
        scene.lights().brightness_along(ray, bounces.kind_of_mirrored_ray(), bounces.of_sampled_light(), kWhite);
    if (!brightness) return 1.0f;
    ++counts[RayUse::Shadow];
    return *brightness > kWhite ? std::min(*brightness, kMostGlint) : 1.0f;
}

}  // namespace

void find_glints(const Scene& scene, const Bounces& bounces, Vertex& vertex, RayCounts& counts) {
    if (scene.lights().empty() || !bounces.is_sharp()) return;
    const Closures& closures = vertex.closures;
    bool any = false;
    for (int i = 0; i < closures.size(); ++i) {
        if (!is_mirror_by_chance(closures[i], closures)) continue;
        vertex.view.lobes[i].glint = glint(scene, bounces, vertex, closures[i], counts);
        any = any || vertex.view.lobes[i].glint > 1.0f;
    }
    if (any) vertex.view.weigh(closures);
}

}  // namespace rayleaf
