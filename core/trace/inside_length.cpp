#include "trace/inside_length.h"

namespace rayleaf {
namespace {

/// A ray through more surfaces than this has met facets that cannot be distinguished.
constexpr int kMostCrossings = 1 << 12;

/// What lies between crossings: how many bodies the ray is in, and since when.
struct Passage {
    int inside = 0;
    double entered = 0, length = 0;

    void cross(bool leaves, double t, double start) {
        if (!leaves) {
            if (inside++ == 0) entered = t;
        } else if (inside > 0) {
            if (--inside == 0) length += t - entered;
        } else {
            length = t - start;  // started inside: whatever was counted lies within
        }
    }
};

}  // namespace

double traced_length(const ShapeScene& scene, const Vec3d& origin, const Vec3d& direction, float time, double t_min,
                     double t_max) {
    const double step = kCrossingStep / direction.length();
    Passage passage;
    double from = t_min;
    for (int crossings = 0; crossings < kMostCrossings; ++crossings) {
        // Past t_max too: only the next crossing shows whether the ray ends inside.
        Maybe<LocalRay> ray =
            clipped_ray(scene.box(), origin, direction, from, std::numeric_limits<double>::infinity());
        ShapeHit hit;
        if (!ray) break;
        ray->time = time;
        if (!scene.closest(*ray, hit)) break;
        const double t = hit.point.t;
        const bool leaves = Vec3d(scene.hit_at(hit, time).normal).dot(direction) > 0.0;
        passage.cross(leaves, std::min(t, t_max), t_min);
        if (t >= t_max) return passage.length;
        from = t + step;
    }
    return passage.length;
}

}  // namespace rayleaf
