// What a path through glass does at each crossing, however its crossings are found.
#pragma once

#include "ri_tree/output_ray.h"

namespace rayleaf {

/// The direction after a crossing: refracted, or totally reflected, which is counted. `facing`: the normal towards
/// where the ray comes from; `turned`: against the surface's own.
template <typename Changes>
Vec3d direction_after(const Vec3d& direction, const Vec3d& facing, double eta, bool turned, SampleClass& path,
                      Changes& changes) {
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

}  // namespace rayleaf
