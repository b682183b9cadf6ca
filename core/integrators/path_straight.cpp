// Paths that go on without being scattered: through transparent surfaces, and by portals.
#include "integrators/glints.h"
#include "integrators/path_tracer.h"
#include "integrators/portals.h"
#include "shading/lobes.h"

namespace rayleaf {

float PathTracer::straight_probability(const Vertex& vertex) const {
    /// How much light scattered rays find beside a ray that goes straight on, in the mean: lamps are seen by that, but
    /// sampled for these, unless a mirror scatters them.
    constexpr float kScatteredLight = 0.5f;
    const Closures& closures = vertex.closures;
    const float straight = average(closures.unscattered());
    if (!(straight > 0.0f)) return 0.0f;
    if (bounces_.is_last()) return 1.0f;
    float scattered = 0.0f;
    for (int i = 0; i < closures.size(); ++i)
        scattered += average(closures[i].weight) * (is_singular(closures[i]) ? 1.0f : kScatteredLight) +
                     glint_weight(closures[i], vertex.view.lobes[i]);
    return straight / (straight + scattered);
}

bool PathTracer::pass_through(const Vertex& vertex, float probability) {
    if (!is_black(vertex.closures.portal.weight)) {
        const float portal = portal_share(vertex.closures);
        if (random(PathDimension::Portal) < portal) return pass_portal(vertex, probability * portal);
        probability *= 1.0f - portal;
    }
    throughput_ *= vertex.closures.transparency / probability;
    if (!is_finite(throughput_)) return false;
    bounces_.pass_through(vertex.point.t);
    // No shadow ray comes by here: lights beyond are found by this ray alone.
    if (!material_->transparent_shadow) departure_.density = 0.0f;
    leave_towards(scene_, vertex.point, vertex.outgoing, -vertex.outgoing, media_);
    ray_ = vertex.point.behind(ray_);
    outside_of_ = kNowhere;
    differential_ = vertex.differential;
    return true;
}

bool PathTracer::pass_portal(const Vertex& vertex, float probability) {
    throughput_ *= vertex.closures.portal.weight / probability;
    if (!is_finite(throughput_)) return false;
    bounces_.pass_portal(vertex.point.t);
    departure_.density = 0.0f;  // no shadow ray goes by portals
    has_departed_ = false;
    ray_ = behind_portal(scene_, vertex, media_);
    outside_of_ = kNowhere;
    differential_ = vertex.differential;
    return true;
}

}  // namespace rayleaf
