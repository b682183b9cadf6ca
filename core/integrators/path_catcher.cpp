// Paths that meet shadow catchers (film/shadow_catcher.h).
#include "integrators/path_tracer.h"

namespace rayleaf {

bool PathTracer::meets_catcher() const {
    return settings_.catches_shadows && !caught_ && !bounces_.is_in_footage() && bounces_.count() == 0 &&
           scene_.catches_shadows(hit_->instance);
}

PathTracer PathTracer::split() {
    PathTracer alone(*this);
    alone.light_.sample.clear();
    alone.bounces_.go_into_footage();
    alone.surface_recorded_ = true;
    MediumStack media;
    for (const SceneMedium* medium : media_.all())
        if (medium->instance != SceneMedium::kWorld && scene_.catches_shadows(medium->instance)) media.enter(medium);
    alone.media_ = media;
    ++counts_.catcher_paths;
    catch_light();
    return alone;
}

/// From now on the path's light is the catcher's.
void PathTracer::catch_light() {
    Vec4f& combined = light_.sample[Pass::combined];
    const float rest = average(throughput_);
    caught_.emplace();
    caught_->objects = Vec4f(combined.x, combined.y, combined.z, alpha_ - rest);
    combined = Vec4f(0.0f);
    if (!settings_.shows_footage || settings_.film_transparent) return;
    caught_->footage.w = rest;
    if (!scene_.has_world()) return;
    const Color world = throughput_ * scene_.world(Vec3f(ray_.direction), differential_, bounces_.at(0));
    if (is_finite(world)) caught_->footage = Vec4f(world.x, world.y, world.z, rest);
}

void PathTracer::take_footage(const PixelSample& alone) {
    const Vec4f& light = alone[Pass::combined];
    light_.sample.add(Pass::footage_light, Color(light.x, light.y, light.z));
}

/// After the path's end: which of its light is the picture's, and which the catchers'.
void PathTracer::divide_by_catchers() {
    PixelSample& sample = light_.sample;
    const Vec4f light = sample[Pass::combined];
    sample[Pass::footage_light].w = light.w;
    if (!caught_) return;
    const auto exposed = [this](const Vec4f& color) {
        const float factor = settings_.exposure;
        return Vec4f(color.x * factor, color.y * factor, color.z * factor, color.w);
    };
    sample[Pass::shadow_catcher] = Vec4f(light.x, light.y, light.z, 0.0f);
    sample[Pass::combined] = exposed(caught_->objects);
    sample[Pass::footage] = exposed(caught_->footage);
}

}  // namespace rayleaf
