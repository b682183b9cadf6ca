#include "trace/shell_check.h"

#include <cmath>

namespace rayleaf {
namespace {

/// On which sides a ray may be: at a silhouette both facets of an edge may be found, one facing each way, and then it
/// may be on either.
struct Sides {
    bool inside, outside;

    bool none() const { return !inside && !outside; }
};

/// Crossings too near to each other to be distinguished.
struct Cluster {
    bool entering = false, leaving = false;

    Sides after(const Sides& before) const {
        if (entering && leaving) return {true, true};
        return entering ? Sides{before.outside, false} : Sides{false, before.inside};
    }
};

}  // namespace

bool finds_crack(const Tracer& tracer, const Ray& ray, ShellSide start, double merge) {
    Ray rest = ray;
    Sides sides{start == ShellSide::Inside, start == ShellSide::Outside};
    Cluster cluster;
    double last = -std::numeric_limits<double>::infinity();
    for (;;) {
        const Maybe<Hit> hit = tracer.closest_hit(rest, kVisibleAll);
        const bool any = cluster.entering || cluster.leaving;
        if (any && (!hit || hit->t - last > merge)) {
            sides = cluster.after(sides);
            cluster = {};
            if (sides.none()) return true;
        }
        if (!hit) return !sides.outside;
        const Vec3d normal = tracer.local_to_world(hit->instance, ray.time).normal(Vec3d(hit->local.normal));
        (normal.dot(ray.direction) > 0.0 ? cluster.leaving : cluster.entering) = true;
        last = hit->t;
        rest.t_min = std::nextafter(hit->t, std::numeric_limits<double>::infinity());
    }
}

}  // namespace rayleaf
