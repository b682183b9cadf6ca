// Paths through participating media.
#include "integrators/medium_light.h"
#include "integrators/medium_majorants.h"
#include "integrators/path_tracer.h"

namespace rayleaf {
Color PathTracer::free_of_media(double t) const {
    if (media_.empty()) return Color(1.0f);
    RandomStream random(sampler_, dimension(vertex_, PathDimension::ShadowWalk));
    const SeenRay seen(ray_, vertex_);
    return transmittance({scene_, media_, seen.ray, t - seen.from, bounces_.at(0)}, random);
}

bool PathTracer::pass_media(double end, std::vector<LightRay>& light_rays) {
    const SeenRay seen(ray_, vertex_);
    const MediumSegment segment{scene_, media_, seen.ray, end - seen.from, bounces_.at(0)};
    const bool scatters = !bounces_.is_last() && media_.scatters();
    RandomStream random(sampler_, dimension(vertex_, PathDimension::MediumWalk));
    const Vec2f numbers = sampler_.get2(dimension(vertex_, PathDimension::Medium));
    MediumPassage passage;
    if (scatters) {
        const SegmentBounds bounds(segment);
        add_scattered_light(segment, bounds, light_rays);
        passage = pass(segment, bounds, throughput_, numbers, random);
    } else {
        passage = pass_unscattered(segment, numbers.x, random);
    }
    if (!is_black(passage.emission)) add(passage.emission, Pass::emission, -1);
    throughput_ *= passage.weight;
    if (!is_finite(throughput_) || is_black(throughput_)) return true;
    if (!passage.t) return false;
    const std::optional<PhaseSample> sample = scattered_direction(
        segment, passage, !bounces_.is_last_in_medium(), sampler_.get3(dimension(vertex_, PathDimension::Scatter)));
    *passage.t += seen.from;
    if (sample) scatter_in_medium(passage, *sample);
    return true;
}

void PathTracer::add_scattered_light(const MediumSegment& segment, const SegmentBounds& bounds,
                                     std::vector<LightRay>& light_rays) {
    const Visibility kind = bounces_.kind_of_shadow_ray();
    const PathState shadow = bounces_.of_shadow_ray();
    const Maybe<ScatteredLight> light = scattered_light(segment, bounds, throughput_, sampler_, vertex_, kind, shadow);
    if (!light) return;
    LightRay& way = light_rays.emplace_back(throughput_ * light->value);
    way.shares = kMediumFirst;
    way.first = bounces_.count() == 0;
    way.group = light->light_group;
    way.scatterings = bounces_.count() + 1;
    if (!light->casts_shadow) {
        receive(way, Color(1.0f));
        light_rays.pop_back();
        return;
    }
    ++counts_[RayUse::Shadow];
    way.ray = light->ray;
    way.kind = light->kind;
    way.state = shadow;
    way.transparent_left = bounces_.transparent_left();
    way.widening = settings_.widening(importance(), false);
    way.media = media_;
    way.random = RandomStream(sampler_, dimension(vertex_, PathDimension::ShadowWalk));
}

/// Where the path ends, `vertex_` stays.
void PathTracer::scatter_in_medium(const MediumPassage& passage, const PhaseSample& sample) {
    const Vec3f direction(ray_.direction);
    throughput_ *= sample.weight;
    if (settings_.feature_passes) features_.meet_medium(passage.weight * sample.weight, light_.sample);
    if (bounces_.count() == 0) first_shares_ = kMediumFirst;
    bounces_.scatter_in_medium(sample.density);
    use_ = RayUse::Medium;
    if (!survives_roulette()) return;
    if (has_footprint_)
        differential_ =
            widened(differential_.transferred(direction, *passage.t, -direction), sample.direction, kScatteredWidth);
    const Vec3d position = ray_.at(*passage.t);
    departure_ = {sample.density, lit_in(scene_, media_, position)};
    has_departed_ = scene_.has_blocked_lights();
    const float time = ray_.time;
    ray_ = Ray{};
    ray_.time = time;
    ray_.origin = position;
    ray_.direction = ray_direction(sample.direction);
    outside_of_ = kNowhere;
    ++vertex_;
}

void PathTracer::pass_boundary() {
    const Vec3f direction(ray_.direction);
    const SurfacePoint point = scene_.tracer().surface_point(ray_, *hit_);
    cross(scene_, point, direction, media_);
    bounces_.pass_boundary(point.t);
    if (has_footprint_) differential_ = differential_.transferred(direction, point.t, point.facet_normal);
    ray_ = point.behind(ray_);
    outside_of_ = kNowhere;
    ++vertex_;
}

}  // namespace rayleaf
