// The walk of a ray through a body of glass, from crossing to crossing, however its crossings are found: by tracing
// (sample_tracer.cpp) or by Newton's iteration (convex_path.cpp).
#pragma once

#include "ri_tree/output_ray.h"
#include "ri_tree/sample_tracer.h"

#include <optional>

namespace rayleaf {

/// Where a path crosses the surface, local space.
struct GlassCrossing {
    Vec3d position, normal;  ///< unit normal, for shading
    Vec3d facet_normal;      ///< of the facet there: which side a ray is on
    uint32_t surface_class = kMissedClass;
};

/// The direction after a crossing: refracted or totally reflected. The latter is counted in `path`.
template <typename Changes>
Vec3d direction_after(const GlassCrossing& crossing, const Vec3d& direction, double ior, SampleClass& path,
                      Changes& changes) {
    const bool from_inside = direction.dot(crossing.facet_normal) > 0.0;
    const bool turned = direction.dot(crossing.normal) > 0.0;
    const Vec3d facing = turned ? -crossing.normal : crossing.normal;
    const double eta = from_inside ? ior : 1.0 / ior;
    if (const std::optional<Vec3d> through = refracted_direction(direction, facing, eta)) {
        changes.refract(direction, facing, eta, turned);
        return *through;
    }
    changes.reflect(direction, facing, turned);
    ++path.total_reflections;
    return mirrored(direction, facing);
}

/// Ends a path that stays inside for too many hits: only its first one is known.
template <typename Changes>
void cut_off(OutputRay& out, Changes& changes) {
    SampleClass& path = out.sample_class;
    path.exit = kMissedClass;
    path.total_reflections = 0;
    path.ending = PathEnding::CutOff;
    out.exit_position = out.position;
    out.exit_direction = out.normal;
    changes.cut_off();
}

/// Sets what `out` says of the way inside and of the exit, for a ray of `direction` that meets the body at `crossing`.
/// `next(direction)`: the crossing that a ray inside meets from the last one on; empty where there is none, and the
/// path has Escaped.
template <typename NextCrossing, typename Changes>
void walk_glass(const SampleSettings& settings, GlassCrossing crossing, Vec3d direction, const NextCrossing& next,
                OutputRay& out, Changes& changes) {
    SampleClass& path = out.sample_class;
    for (;;) {
        direction = direction_after(crossing, direction, settings.ior, path, changes);
        out.exit_position = crossing.position;
        out.exit_direction = direction;
        path.exit = crossing.surface_class;
        // The facet decides on which side the ray is: a shading normal may differ from it.
        if (direction.dot(crossing.facet_normal) >= 0.0) {
            path.ending = PathEnding::Left;
            break;
        }
        if (path.interior_hits == settings.most_interior_hits) {
            cut_off(out, changes);
            return;
        }
        const std::optional<GlassCrossing> found = next(direction);
        if (!found) {
            path.ending = PathEnding::Escaped;
            break;
        }
        crossing = *found;
        ++path.interior_hits;
    }
    changes.leave();
}

}  // namespace rayleaf
