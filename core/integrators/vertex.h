// A vertex of a path, and what its lobes make of light: shared by the integrators.
#pragma once

#include "integrators/contributions.h"
#include "lights/light.h"
#include "rays/ray_differential.h"
#include "shading/closure_view.h"
#include "shading/scatter_lanes.h"

#include <optional>

namespace rayleaf {

/// Weight of the technique with density `a` beside one with density `b` (Veach 1997, equation 9.15, beta 2). Of the
/// ratio, so that no square leaves the range of floats. With n samples of a technique its density counts n times
/// (equation 9.13).
inline float power_heuristic(float a, float b) {
    const float ratio = b / a;
    return 1.0f / (1.0f + ratio * ratio);
}

/// The same over the density `a`, in one division.
inline float weight_over_density(float a, float b) {
    const double x = a, y = b;  // the squares are in the range of doubles
    return static_cast<float>(x / (x * x + y * y));
}

/// A unit vector as the direction of a ray: its length is 1 but for the rounding of doubles, not of floats. Where it is
/// none, along z.
inline Vec3d ray_direction(const Vec3f& unit) {
    constexpr double kMostExcess = 1e-5;
    const Vec3d direction(unit);
    const double excess = direction.length2() - 1.0;
    if (!(std::abs(excess) < kMostExcess)) return normalized_or(direction, Vec3d(0, 0, 1));
    return direction * (1.0 - excess * (0.5 - 0.375 * excess));  // the series of the inverse root
}

/// A hit and all that is known there.
struct Vertex {
    SurfacePoint point;
    Vec3f outgoing{0, 0, 1};
    RayDifferential differential;
    LitPoint lit;  ///< to lights, once they are sampled
    Closures closures;
    ClosureView view;  ///< of the closures, for light and scattering
    /// Where the view, the direction to go on by and what the lobes make of sampled lights were found together with
    /// those of other vertices: the latter two.
    std::optional<LobeSample> scattered;
    LitByLights lit_by_lights;
    bool is_foreseen = false;

    void look() {
        if (!is_foreseen) view.look(closures, outgoing);
    }
    /// `random` as in Closures::sample.
    std::optional<LobeSample> scatter(const Vec3f& random) const {
        return is_foreseen ? scattered : closures.sample(view, point.facet_normal, random);
    }
};

/// What the lobes make of light from one direction.
struct LitLobes {
    Color value{0, 0, 0};  ///< times the cosine
    float density = 0;     ///< with which scattering chooses the direction
    ByKind shares;         ///< filled where asked for
};

/// The vertex as a light that is chosen for it sees it.
inline LitPoint lit(const Scene& scene, const Vertex& vertex) {
    LitPoint point = scene.lit(vertex.point);
    point.normal = vertex.closures.lit_side();
    return point;
}

/// Whether the lobes of all kinds are lit; rays of the camera may not see the light itself.
bool lights_all_kinds(const LightSample& light);
/// By the lobes of `closures`, which are all or some of those of the vertex, as `view` sees them.
LitLobes lit_together(const Vertex& vertex, const Closures& closures, const ClosureView& view,
                      const LightSample& light);
/// The same of the vertex's closures, where it is foreseen and the light is that of this number.
LitLobes lit_as_foreseen(const Vertex& vertex, const LightSample& light, size_t number);
/// The normal that decides on which side of the vertex a light is: the smooth surface's, so that facets do not show
/// where light grazes; a facet's own where it is seen at a silhouette whose surface faces away.
const Vec3f& side_normal(const Vertex& vertex);
/// The same with shares. Only kinds that see the light are lit by it.
LitLobes lit_by_kind(const Vertex& vertex, const Closures& closures, const ClosureView& view, const LightSample& light);
/// How much of each kind's light a ray carries that the lobes of `closures` scattered.
ByKind shares_of_scattering(const Vertex& vertex, const Closures& closures, const LobeSample& sample);

}  // namespace rayleaf
