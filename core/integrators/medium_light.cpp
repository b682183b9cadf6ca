#include "integrators/medium_light.h"

#include "integrators/dimensions.h"
#include "integrators/medium_glow.h"
#include "integrators/vertex.h"

namespace rayleaf {

Maybe<ScatteredLight> scattered_light(const MediumSegment& segment, const SegmentBounds& bounds,
                                      const Color& throughput, const Sampler& sampler, int vertex, Visibility kind,
                                      const PathState& shadow) {
    const LightSet& lights = segment.scene.lights();
    if (lights.empty()) return std::nullopt;
    RandomStream random(sampler, dimension(vertex, PathDimension::MediumPlace));
    const double likely_t = lights.weighs_passed() ? likely_distance(segment, bounds, random.next()) : 0.0;
    const Vec3d likely = segment.ray.at(likely_t);
    const PassedLights passed =
        lights.passed(segment.ray, segment.end, lit_in(segment.scene, segment.media, likely), random.next());
    const Vec2f numbers = sampler.get2(dimension(vertex, PathDimension::MediumPlace));
    const std::optional<LitPlace> place = place_of_light(segment, bounds, throughput, passed, numbers, random);
    if (!place) return std::nullopt;
    const Vec3d position = segment.ray.at(place->t);
    PathState path = shadow;
    path.shadow = false;
    LitPoint at = lit_in(segment.scene, segment.media, position);
    LightQuery query{&at, sampler.get2(dimension(vertex, PathDimension::MediumLight)), segment.ray.time, path, {}};
    lights.sample({&query, 1});
    const Maybe<LightSample>& light = query.light;
    if (!light || !(light->visibility & in_world_of(kind, kVisibleVolume))) return std::nullopt;
    const Vec3f outgoing = segment.outgoing();
    const float density = place->medium.density(outgoing, light->direction);
    const float weight = light->delta ? 1.0f : power_heuristic(light->density, density);
    const Color value = place->weight * place->medium.evaluate(outgoing, light->direction) *
                        (light->radiance / light->density) * weight;
    if (!is_finite(value) || is_black(value)) return std::nullopt;
    Maybe<ScatteredLight> result;
    ScatteredLight& scattered = result.emplace();
    scattered.value = value;
    scattered.light_group = segment.scene.light_group(*light);
    scattered.casts_shadow = light->casts_shadow;
    scattered.kind = to_light(kind, light->blockers);
    Ray& ray = scattered.ray;
    ray.time = segment.ray.time;
    ray.origin = position;
    ray.direction = normalized_or(Vec3d(light->direction), Vec3d(0, 0, 1));
    if (std::isfinite(light->distance)) {
        ray.end = light->target_anchor;
        const Vec3d way = light->target - position;
        ray.direction = normalized_or(way, ray.direction);
        ray.t_max = way.length();
    }
    return result;
}

std::optional<PhaseSample> scattered_direction(const MediumSegment& segment, const MediumPassage& passage, bool goes_on,
                                               const Vec3f& random) {
    const Vec3f outgoing = segment.outgoing();
    if (!goes_on) return passage.medium.sample(outgoing, random);
    const LitPoint at = lit_in(segment.scene, segment.media, segment.ray.at(*passage.t));
    const LampGlow glow(segment.scene.lights().placed(at.lit_by), at.position,
                        max_component(passage.medium.extinction));
    return glow.sample(passage.medium, outgoing, random);
}

}  // namespace rayleaf
