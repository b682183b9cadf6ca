#include "integrators/blocked_light.h"

#include <utility>

namespace rayleaf {
namespace {

/// Crossings of one emitting object that count.
constexpr int kMostEmittingHits = 16;

/// What of the light at `end` of the way arrives.
Color share_up_to(const Scene& scene, const FreeWay& shadow, const Ray& end, int blockers) {
    FreeWay way = shadow;
    way.ray = end;
    way.kind = to_light(shadow.kind, blockers);
    return free_share(scene, std::move(way));
}

/// From the ray's start to a surface, off its facet.
Ray ray_up_to(const Ray& ray, const SurfacePoint& point) {
    Ray result = ray;
    const Vec3d way = point.ray_origin(-ray.direction) - ray.origin;
    result.end = point.anchor();
    result.direction = normalized_or(way, ray.direction);
    result.t_max = way.length();
    return result;
}

class BlockedLights {
  public:
    BlockedLights(const Scene& scene, const FreeWay& way, const FreeWay& shadow, const LitPoint& from,
                  const std::function<void(const BlockedLight&)>& add)
        : scene_(scene), way_(way), shadow_(shadow), from_(from), add_(add) {}

    void find_lamps() const {
        if (!scene_.lights().has_hittable_lamps_with_blockers()) return;
        PathState path = shadow_.state;
        path.shadow = false;
        scene_.lights().lamp_hits(way_.ray, way_.ray.t_max, from_, way_.kind, path, [&](const LampHit& hit) {
            if (hit.blockers < 0) return;
            Ray ray = way_.ray;
            ray.t_max = hit.t;
            add_({hit.radiance * share_up_to(scene_, shadow_, ray, hit.blockers), hit.density, hit.light_group});
        });
    }

    void find_emitters() const {
        for (const uint32_t instance : scene_.lights().emitters_with_blockers()) {
            const LightLink link = scene_.linking(instance).as_light;
            if ((scene_.tracer().instance(instance).visibility & way_.kind) == 0) continue;
            if ((link.set() & from_.lit_by) != 0) find_on(instance, link.blockers);
        }
    }

  private:
    const Scene& scene_;
    const FreeWay& way_;
    const FreeWay& shadow_;
    const LitPoint& from_;
    const std::function<void(const BlockedLight&)>& add_;

    /// All crossings: its own surface may be no blocker.
    void find_on(uint32_t instance, int blockers) const {
        Ray ray = way_.ray;
        for (int i = 0; i < kMostEmittingHits; ++i) {
            const Maybe<Hit> hit = scene_.tracer().closest_on(instance, ray);
            if (!hit) return;
            const SurfacePoint point = scene_.tracer().surface_point(ray, *hit);
            Closures closures;
            PathState state = way_.state;
            state.ray_length += static_cast<float>((point.position - way_.ray.origin).length());
            scene_.shade(point, -Vec3f(ray.direction), {}, state, closures);
            if (!is_black(closures.emission)) {
                const Color share = share_up_to(scene_, shadow_, ray_up_to(way_.ray, point), blockers);
                add_({closures.emission * share, scene_.lights().emitter_density(from_, point),
                      scene_.light_group(instance)});
            }
            ray = point.behind(ray);
        }
    }
};

}  // namespace

void find_blocked_lights(const Scene& scene, const FreeWay& way, const FreeWay& shadow, const LitPoint& from,
                         const std::function<void(const BlockedLight&)>& add) {
    const BlockedLights lights(scene, way, shadow, from, add);
    lights.find_lamps();
    lights.find_emitters();
}

}  // namespace rayleaf
