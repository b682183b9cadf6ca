#include "ri_tree/convex_path.h"

#include "ri_tree/glass_walk.h"

#include <type_traits>

namespace rayleaf {
namespace {

using Meeting = ConvexBody::Meeting;

/// Tells `changes` of a crossing. The surface's derivatives are computed only where they are wanted.
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
    out = {};
    ConvexBody::Crossing crossing;
    const Meeting entry = body.enter(ray.origin, ray.direction, crossing);
    if (entry != Meeting::Crossed) return entry;
    const auto crossed = [&] {
        return GlassCrossing{crossing.position, crossing.normal, crossing.normal,
                             tracer.classes().of_element(crossing.element)};
    };
    arrive(tracer, crossing, ray.direction, changes);
    changes.first_hit();
    out.sample_class.first_hit = tracer.classes().of_element(crossing.element);
    out.position = crossing.position;
    out.normal = crossing.normal;
    const auto next = [&](const Vec3d& direction) -> std::optional<GlassCrossing> {
        const Vec3d from = crossing.position;
        if (body.leave(from, direction, crossing) != Meeting::Crossed) return std::nullopt;
        arrive(tracer, crossing, direction, changes);
        return crossed();
    };
    walk_glass(tracer.settings(), crossed(), ray.direction, next, out, changes);
    return out.sample_class.ending == PathEnding::Escaped ? Meeting::Uncertain : Meeting::Crossed;
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
