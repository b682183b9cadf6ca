// A ray through a body of clear glass, from where it enters to where it leaves, as one step of a path; for both ways of
// tracing.
//
// The model (scene/material_optics.h, GlassBody) is the same whether the way is interpolated or traced, so that a
// picture does not show which it was.
#pragma once

#include "integrators/bounces.h"
#include "integrators/vertex.h"
#include "scene/scene.h"

#include <optional>

namespace rayleaf {

/// What changes of a path on the way through a body.
struct GlassCrosser {
    Ray& ray;  ///< has just passed the surface; then the one that leaves
    RayDifferential& differential;
    Bounces& bounces;
    Color& throughput;
};

enum class GlassOutcome : uint8_t {
    BySurfaces,  ///< nothing has changed: the path goes on surface by surface
    Left,
    Ended  ///< inside: by a limit of bounces, or black
};

/// Goes on from where a ray that has just entered an object leaves it, if that is a glass body (Scene::glass_body): as
/// the ray cache of its hit `entered` knows the way, else by tracing it. Each hit from inside counts as the bounce that
/// it is; of at most `most_interior_hits`.
GlassOutcome cross_glass(const Scene& scene, const Hit& entered, const Vertex& vertex, int most_interior_hits,
                         GlassCrosser path);

/// What `ray` meets that has left the glass of `outside_of`, and has `found` this. It cannot meet that from inside,
/// unless the point where it was said to leave lay a little inside: then that surface is not there, and what lies
/// behind counts. `differential`: as of Tracer::closest.
ClosestHit outside_glass(const Scene& scene, uint32_t outside_of, Ray& ray, Visibility kind,
                         const RayDifferential* differential, ClosestHit found);

}  // namespace rayleaf
