#include "integrators/medium_stack.h"

namespace rayleaf {
namespace {

/// Whether a point lies inside a closed surface: the first facet on any way out is seen from behind.
const SceneMedium* medium_holding(const Scene& scene, uint32_t instance, const Vec3d& position, float time) {
    if (!scene.tracer().bounds(instance).intersects(position)) return nullptr;
    Ray up;
    up.origin = position;
    up.time = time;
    const Maybe<Hit> hit = scene.tracer().closest_on(instance, up);
    if (!hit) return nullptr;
    const SurfacePoint point = scene.tracer().surface_point(up, *hit);
    if (point.facet_normal.dot(Vec3f(up.direction)) <= 0.0f) return nullptr;
    return scene.media().find(instance, scene.material(instance, hit->local));
}

}  // namespace

void MediumStack::enter(const SceneMedium* medium) {
    if (count_ == kMost || std::find(media_.begin(), media_.begin() + count_, medium) != media_.begin() + count_)
        return;
    media_[count_++] = medium;
}

void MediumStack::leave(const SceneMedium* medium) {
    const auto end = std::remove(media_.begin(), media_.begin() + count_, medium);
    count_ = static_cast<size_t>(end - media_.begin());
}

bool MediumStack::varies() const {
    const auto has_grid = [](const SceneMedium* medium) { return medium->grid != nullptr; };
    return std::any_of(media_.begin(), media_.begin() + count_, has_grid);
}

bool MediumStack::emits() const {
    return std::ranges::any_of(all(), [](const SceneMedium* medium) { return medium->program->emits(); });
}

bool MediumStack::scatters() const {
    return std::ranges::any_of(all(), [](const SceneMedium* medium) { return medium->program->scatters(); });
}

MediumStack media_around(const Scene& scene, const Vec3d& position, float time) {
    MediumStack media;
    if (const SceneMedium* world = scene.media().world()) media.enter(world);
    for (const uint32_t instance : scene.media().instances())
        if (const SceneMedium* medium = medium_holding(scene, instance, position, time)) media.enter(medium);
    return media;
}

void cross(const Scene& scene, const SurfacePoint& point, const Vec3f& direction, MediumStack& media) {
    const Material& material = scene.material(point.instance, point.local);
    if (!material.medium) return;
    const SceneMedium* medium = scene.media().find(point.instance, material);
    if (point.facet_normal.dot(direction) < 0.0f)
        media.enter(medium);
    else
        media.leave(medium);
}

}  // namespace rayleaf
