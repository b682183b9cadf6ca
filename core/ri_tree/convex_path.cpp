#include "ri_tree/convex_path.h"

#include "ri_tree/glass_steps.h"

#include <type_traits>

namespace rayleaf {
namespace {

using Meeting = ConvexBody::Meeting;

/// What changes need of the surface is computed for those who want them alone.
template <typename Changes>
void arrive(const SampleTracer& tracer, const ConvexBody::Crossing& crossing, const Vec3d& direction,
            Changes& changes) {
    if constexpr (!std::is_same_v<Changes, UnknownChanges>) {
        LocalHit hit;
        hit.primitive = crossing.element;
        hit.u = crossing.at.x;
        hit.v = crossing.at.y;
        hit.position = crossing.position;
        hit.normal = Vec3f(crossing.normal);
        changes.arrive(crossing.position, direction, tracer.shape().surface(hit), crossing.normal);
    }
}

template <typename Changes>
Meeting follow(const ConvexBody& body, const SampleTracer& tracer, const Ray& ray, OutputRay& out, Changes& changes) {
    const SampleSettings& settings = tracer.settings();
    out = {};
    ConvexBody::Crossing crossing;
    const Meeting entry = body.enter(ray.origin, ray.direction, crossing);
    if (entry != Meeting::Crossed) return entry;
    arrive(tracer, crossing, ray.direction, changes);
    changes.first_hit();
    SampleClass& path = out.sample_class;
    path.first_hit = tracer.classes().of_element(crossing.element);
    out.position = crossing.position;
    out.normal = crossing.normal;
    Vec3d direction = ray.direction;
    for (;;) {
        const bool from_inside = path.interior_hits > 0;
        const Vec3d facing = from_inside ? -crossing.normal : crossing.normal;
        const double eta = from_inside ? settings.ior : 1.0 / settings.ior;
        direction = direction_after(direction, facing, eta, from_inside, path, changes);
        out.exit_position = crossing.position;
        out.exit_direction = direction;
        path.exit = tracer.classes().of_element(crossing.element);
        if (direction.dot(crossing.normal) >= 0.0) {
            path.ending = PathEnding::Left;
            changes.leave();
            return Meeting::Crossed;
        }
        if (path.interior_hits == settings.most_interior_hits) {
            cut_off(out, changes);
            return Meeting::Crossed;
        }
        const Vec3d from = crossing.position;
        if (body.leave(from, direction, crossing) != Meeting::Crossed) return Meeting::Uncertain;
        arrive(tracer, crossing, direction, changes);
        ++path.interior_hits;
    }
}

}  // namespace

Meeting follow_glass(const ConvexBody& body, const SampleTracer& tracer, const Ray& ray, OutputRay& out) {
    UnknownChanges changes;
    return follow(body, tracer, ray, out, changes);
}

Meeting follow_glass(const ConvexBody& body, const SampleTracer& tracer, const Ray& ray, const RayChanges& ray_changes,
                     OutputRay& out, OutputChanges& changes) {
    changes = {};
    PathChanges path(ray.origin, ray_changes, changes);
    return follow(body, tracer, ray, out, path);
}

}  // namespace rayleaf
