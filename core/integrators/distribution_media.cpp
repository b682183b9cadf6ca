// Distribution ray tracing through participating media: one ray goes on from a place that scatters.
#include "integrators/distribution_tracer.h"
#include "integrators/medium_light.h"
#include "integrators/medium_majorants.h"

namespace rayleaf {
Color DistributionTracer::free_of_media(const Branch& branch, double t) const {
    if (branch.media.empty()) return Color(1.0f);
    RandomStream random(branch.sampler, dimension(branch.vertex, PathDimension::ShadowWalk));
    const SeenRay seen(branch.ray, branch.vertex);
    return transmittance({scene_, branch.media, seen.ray, t - seen.from, branch.bounces.at(0)}, random);
}

void DistributionTracer::add_scattered_light(const Branch& branch, const MediumSegment& segment,
                                             const SegmentBounds& bounds) {
    const PathState state = branch.bounces.of_shadow_ray();
    const Maybe<ScatteredLight> light =
        scattered_light(segment, bounds, branch.throughput, branch.sampler, branch.vertex, kVisibleShadow, state);
    if (!light) return;
    Color value = branch.throughput * light->value;
    if (light->casts_shadow) {
        ++(*counts_)[RayUse::Shadow];
        FreeWay shadow = way_of(branch, light->ray);
        shadow.differential = {};
        shadow.kind = light->kind;
        shadow.state = state;
        shadow.widening = settings_.widening(branch.importance(), false);
        value *= free_share(scene_, shadow);
    }
    if (is_black(value)) return;
    if (branch.bounces.count() == 0)
        light_.add_first(value, kMediumFirst, light->light_group, branch.share);
    else
        light_.add_scattered(value, branch.bounces.count() + 1, branch.first_shares, light->light_group, branch.share);
}

bool DistributionTracer::pass_media(Branch& branch, double end) {
    const SeenRay seen(branch.ray, branch.vertex);
    const MediumSegment segment{scene_, branch.media, seen.ray, end - seen.from, branch.bounces.at(0)};
    const bool scatters = !branch.bounces.is_last() && branch.media.scatters();
    RandomStream random(branch.sampler, dimension(branch.vertex, PathDimension::MediumWalk));
    const Vec2f numbers = branch.sampler.get2(dimension(branch.vertex, PathDimension::Medium));
    MediumPassage passage;
    if (scatters) {
        const SegmentBounds bounds(segment);
        add_scattered_light(branch, segment, bounds);
        passage = pass(segment, bounds, branch.throughput, numbers, random);
    } else {
        passage = pass_unscattered(segment, numbers.x, random);
    }
    if (!is_black(passage.emission)) add(branch, passage.emission, Pass::emission, -1);
    branch.throughput *= passage.weight;
    if (!is_finite(branch.throughput) || is_black(branch.throughput)) return true;
    if (!passage.t) return false;
    const std::optional<PhaseSample> sample =
        scattered_direction(segment, passage, !branch.bounces.is_last_in_medium(),
                            branch.sampler.get3(dimension(branch.vertex, PathDimension::Scatter)));
    if (!sample) return true;
    *passage.t += seen.from;
    const Vec3f direction(branch.ray.direction);
    Branch child = branch;
    child.throughput *= sample->weight;
    if (settings_.feature_passes && branch.shows_features)
        branch.features.meet_medium(passage.weight * sample->weight, light_.sample);
    if (child.bounces.count() == 0) child.first_shares = kMediumFirst;
    child.shows_features = false;
    child.bounces.scatter_in_medium(sample->density);
    child.use = RayUse::Medium;
    child.differential =
        widened(branch.differential.transferred(direction, *passage.t, -direction), sample->direction, kScatteredWidth);
    child.departure = {};
    child.departure.from = lit_in(scene_, branch.media, branch.ray.at(*passage.t));
    child.has_departed = scene_.has_blocked_lights();
    child.departure.sampling = LightSampling::Weighed;
    child.departure.density = sample->density;
    child.ray = Ray{};
    child.ray.time = branch.ray.time;
    child.ray.origin = child.departure.from.position;
    child.ray.direction = ray_direction(sample->direction);
    ++child.vertex;
    push(std::move(child));
    return true;
}

void DistributionTracer::pass_boundary(const Branch& branch, const Hit& hit) {
    if (branch.vertex >= kMostVertices) return;
    const Vec3f direction(branch.ray.direction);
    const SurfacePoint point = scene_.tracer().surface_point(branch.ray, hit);
    Branch child = branch;
    cross(scene_, point, direction, child.media);
    child.bounces.pass_boundary(point.t);
    child.differential = branch.differential.transferred(direction, point.t, point.facet_normal);
    child.has_departed = false;
    child.ray = point.behind(branch.ray);
    ++child.vertex;
    pending_.push_back(std::move(child));
}

}  // namespace rayleaf
