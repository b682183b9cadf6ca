// The way of a ray through a convex body of glass, from crossing to crossing (convex_body.h).
#pragma once

#include "ri_tree/convex_body.h"
#include "ri_tree/output_ray.h"
#include "ri_tree/path_changes.h"
#include "ri_tree/sample_tracer.h"

namespace rayleaf {

/// How far exit rays are off, a share of the half extent: single precision, after several crossings.
inline constexpr double kFollowedError = 0x1p-14;

/// Whether a ray that starts outside the body and points towards it meets it; then `out` is its output ray: what the
/// tracer makes of it, up to the facets' distance from the surface. Uncertain where one of the crossings is. Local
/// space.
ConvexBody::Meeting follow_glass(const ConvexBody& body, const SampleTracer& tracer, const Ray& ray, OutputRay& out);
/// The same, and how it changes if the ray changes so at its origin.
ConvexBody::Meeting follow_glass(const ConvexBody& body, const SampleTracer& tracer, const Ray& ray,
                                 const RayChanges& ray_changes, OutputRay& out, OutputChanges& changes);

}  // namespace rayleaf
