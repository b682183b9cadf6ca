// The media that a ray is in: those whose borders it has crossed from outside and not yet from inside. Where several
// overlap, they add up, as in Cycles; which was entered first does not matter.
#pragma once

#include "scene/scene.h"

#include <array>
#include <span>

namespace rayleaf {

class MediumStack {
  public:
    /// More than so many at a place are not noticed.
    static constexpr size_t kMost = 8;

    bool empty() const { return count_ == 0; }
    std::span<const SceneMedium* const> all() const { return {media_.data(), count_}; }
    /// Once, however often its border is crossed inwards.
    void enter(const SceneMedium* medium);
    void leave(const SceneMedium* medium);
    /// Whether any varies from place to place.
    bool varies() const;
    /// Whether any may emit light, or scatter it.
    bool emits() const;
    bool scatters() const;

  private:
    size_t count_ = 0;
    std::array<const SceneMedium*, kMost> media_;
};

/// The media at a point that lies on no surface, where a path starts; `time` of the shutter.
MediumStack media_around(const Scene& scene, const Vec3d& position, float time);

/// A point in media, which the lights of the first shine on, as in Cycles. There must be one.
inline LitPoint lit_in(const Scene& scene, const MediumStack& media, const Vec3d& position) {
    return scene.lit(media.all().front()->instance, position);
}

/// The part of a ray that media may change. Of the camera's (`vertex` 0) it begins where clipping ends, as in Cycles.
struct SeenRay {
    Ray ray;
    double from = 0;  ///< on the whole ray, world units

    SeenRay(const Ray& whole, int vertex) : ray(whole), from(vertex == 0 ? whole.t_min : 0.0) {
        if (from > 0.0) ray.origin = whole.at(from);
    }
};

/// The media beyond a surface point, for a ray that goes on through it along `direction`.
void cross(const Scene& scene, const SurfacePoint& point, const Vec3f& direction, MediumStack& media);

/// The media that a ray is in that leaves a point along `direction`; `outgoing` is on the side of `media`.
inline void leave_towards(const Scene& scene, const SurfacePoint& point, const Vec3f& outgoing, const Vec3f& direction,
                          MediumStack& media) {
    const Vec3f& facet = point.facet_normal;
    if (scene.has_media() && facet.dot(outgoing) * facet.dot(direction) < 0.0f) cross(scene, point, direction, media);
}

}  // namespace rayleaf
