#include "integrators/branch.h"

#include "integrators/portals.h"

namespace rayleaf {
namespace {

/// Rays dimmer than this end by chance: bounds the number of rays that mirrors and glass make of one. A surface sends
/// on at most what it gets, so at most the inverse of it are followed at a time.
constexpr float kLeastImportance = 0.01f;
/// The least probability of going on beyond hemisphere rays, as in path tracing.
constexpr float kLeastBranchSurvival = 0.05f;

}  // namespace

Branch Branch::scattered(const Scene& scene, const Vertex& from, const Closures& closures, const LobeSample& sample,
                         int count) const {
    Branch child = *this;
    child.ray = Ray{};
    from.point.release(child.ray, ray_direction(sample.direction));
    child.departure = {};
    child.departure.from = lit(scene, from);
    child.has_departed = scene.has_blocked_lights();
    child.bounces.scatter(sample);
    child.throughput *= sample.weight / static_cast<float>(count);
    child.share /= static_cast<float>(count);
    if (splits_light && bounces.count() == 0) child.first_shares = shares_of_scattering(from, closures, sample);
    child.shows_features = false;
    child.outside_of = RayAnchor::kNone;
    ++child.vertex;
    return child;
}

Branch Branch::unscattered(const Vertex& from, const Color& weight) const {
    Branch child = *this;
    child.has_departed = false;
    child.outside_of = RayAnchor::kNone;
    child.differential = from.differential;
    child.throughput *= weight;
    ++child.vertex;
    return child;
}

Branch Branch::straight_on(const Scene& scene, const Vertex& from) const {
    Branch child = unscattered(from, from.closures.transparency);
    child.ray = from.point.behind(ray);
    child.bounces.pass_through(from.point.t);
    // No shadow ray comes by here: lights beyond are found by this ray alone.
    if (!scene.material(from.point.instance, from.point.local).transparent_shadow)
        child.departure.sampling = LightSampling::None;
    return child;
}

Branch Branch::by_portal(const Scene& scene, const Vertex& from) const {
    Branch child = unscattered(from, from.closures.portal.weight);
    child.ray = behind_portal(scene, from, child.media);
    child.bounces.pass_portal(from.point.t);
    child.departure.sampling = LightSampling::None;  // no shadow ray goes by portals
    return child;
}

bool survives(Branch& branch, const PathSettings& settings) {
    const float importance = branch.importance();
    if (!(importance > 0.0f) || !is_finite(branch.throughput)) return false;
    float survival = 1.0f;
    if (branch.spread == Spread::Many)
        survival = std::min(importance / kLeastImportance, 1.0f);
    else if (branch.bounces.count() > settings.roulette_start)
        survival = std::clamp(importance, kLeastBranchSurvival, 1.0f);
    if (survival < 1.0f && branch.random(PathDimension::Roulette) >= survival) return false;
    branch.throughput /= survival;
    return true;
}

}  // namespace rayleaf
