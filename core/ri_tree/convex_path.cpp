#include "ri_tree/convex_path.h"

namespace rayleaf {

using Meeting = ConvexBody::Meeting;

Meeting follow_glass(const ConvexBody& body, const PatchClasses& classes, const SampleSettings& settings,
                     const Ray& local_ray, OutputRay& out) {
    out = {};
    ConvexBody::Crossing crossing;
    const Meeting entry = body.enter(local_ray.origin, local_ray.direction, crossing);
    if (entry != Meeting::Crossed) return entry;
    SampleClass& path = out.sample_class;
    path.first_hit = classes.of_element(crossing.element);
    out.position = crossing.position;
    out.normal = crossing.normal;
    Vec3d direction = local_ray.direction;
    for (;;) {
        const bool from_inside = path.interior_hits > 0;
        const Vec3d facing = from_inside ? -crossing.normal : crossing.normal;
        const std::optional<Vec3d> through =
            refracted_direction(direction, facing, from_inside ? settings.ior : 1.0 / settings.ior);
        if (!through) ++path.total_reflections;
        direction = through ? *through : mirrored(direction, facing);
        out.exit_position = crossing.position;
        out.exit_direction = direction;
        path.exit = classes.of_element(crossing.element);
        if (direction.dot(crossing.normal) >= 0.0) {
            path.ending = PathEnding::Left;
            return Meeting::Crossed;
        }
        if (path.interior_hits == settings.most_interior_hits) {
            path.exit = kMissedClass;
            path.total_reflections = 0;
            path.ending = PathEnding::CutOff;
            out.exit_position = out.position;
            out.exit_direction = out.normal;
            return Meeting::Crossed;
        }
        const Vec3d from = crossing.position;
        if (body.leave(from, direction, crossing) != Meeting::Crossed) return Meeting::Uncertain;
        ++path.interior_hits;
    }
}

}  // namespace rayleaf
