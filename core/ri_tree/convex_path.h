// The path of a ray through a convex body of glass, from crossing to crossing (convex_body.h).
#pragma once

#include "ri_tree/convex_body.h"
#include "ri_tree/output_ray.h"
#include "ri_tree/path_changes.h"
#include "ri_tree/sample_tracer.h"

namespace rayleaf {

/// Error of exit rays, as a share of the half extent: single precision, after several crossings.
inline constexpr double kFollowedError = 0x1p-14;

/// Whether a ray meets the body, which it must start outside of and point towards. If so, `out` is its output ray: that
/// of the tracer, up to the facets' distance from the surface. Uncertain if one of the crossings is. Local space.
///
ConvexBody::Meeting follow_glass(const ConvexBody& body, const SampleTracer& tracer, const Ray& ray, OutputRay& out);
/// The same, and the derivatives of `out` for those of the ray at its origin.
ConvexBody::Meeting follow_glass(const ConvexBody& body, const SampleTracer& tracer, const Ray& ray,
                                 const RayChanges& ray_changes, OutputRay& out, OutputChanges& changes);

}  // namespace rayleaf
