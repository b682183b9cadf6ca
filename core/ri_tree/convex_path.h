// The way of a ray through a convex body of glass, from crossing to crossing (convex_body.h).
#pragma once

#include "ri_tree/convex_body.h"
#include "ri_tree/output_ray.h"
#include "ri_tree/patch_classes.h"
#include "ri_tree/sample_tracer.h"

#include <optional>

namespace rayleaf {

/// How far exit rays are off, a share of the half extent: single precision, after several crossings.
inline constexpr double kFollowedError = 0x1p-14;

/// The output ray of a ray that starts outside the body and points towards it: what tracing makes of it, up to the
/// facets' distance from the surface. Empty where a crossing is uncertain, and for rays that miss.
std::optional<OutputRay> follow_glass(const ConvexBody& body, const PatchClasses& classes,
                                      const SampleSettings& settings, const Ray& local_ray);

}  // namespace rayleaf
