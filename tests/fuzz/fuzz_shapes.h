// Rays against a drawn shape: what every answer must hold.
#pragma once

#include "fuzz_input.h"
#include "trace/tracer.h"

#include <memory>

namespace rayleaf::fuzz {

/// Traces drawn rays against one instance of the shape.
inline void trace_drawn_rays(const std::shared_ptr<const Shape>& shape, Bytes& bytes) {
    TracedInstance instance{shape, {}};
    DicingView view;
    view.pixel_angle = 0.1;  // few subpatches: the fuzzer wants many runs
    const Tracer tracer({instance}, view);
    for (int i = 0; i < 8 && !bytes.empty(); ++i) {
        Ray ray;
        for (int axis = 0; axis < 3; ++axis) {
            ray.origin[axis] = bytes.number();
            ray.direction[axis] = bytes.number();
        }
        ray.direction = bytes.flag() ? ray.direction : normalized_or(ray.direction, Vec3d(0, 0, 1));
        const Maybe<Hit> hit = tracer.closest_hit(ray, kVisibleCamera);
        if (!hit) continue;
        require(std::isfinite(hit->t) && hit->t >= ray.t_min);
        const SurfacePoint point = tracer.surface_point(ray, *hit);
        require(is_finite(point.position) && is_finite(point.normal) && is_finite(point.facet_normal));
        require(std::abs(point.normal.length() - 1.0f) < 1e-4f);
        require(tracer.occluded(ray, kVisibleCamera));
    }
}

}  // namespace rayleaf::fuzz
