#include "integrators/path_tracer.h"

#include "integrators/ambient_occlusion.h"
#include "integrators/blocked_light.h"
#include "integrators/first_surface.h"
#include "integrators/glass_path.h"
#include "integrators/glints.h"
#include "integrators/ray_passes.h"
#include "integrators/scattered_differential.h"
#include "integrators/shadow.h"
#include "integrators/subsurface_walk.h"
#include "integrators/volumes.h"
#include "shading/lobes.h"

namespace rayleaf {
namespace {

/// The least probability of going on: bounds what a surviving path is multiplied by.
constexpr float kLeastSurvival = 0.05f;

/// What a scattered ray is before it has a place: copied, which costs less than to make one.
const Ray kNewRay;

/// Lights that are sampled where the camera looks, if there are several. Which light is chosen makes noise, and one
/// more costs little beside the rest of the path. Further along it is not worth it.
constexpr int kFirstLightRays = kMostLights;

/// The numbers of sample `index` of `count` made of a pair: x in the part of the unit interval that is its own, so that
/// lights are chosen evenly; y moved on by as large a part, so that two places on one light lie apart.
Vec2f numbers_of_part(const Vec2f& pair, int index, int count) {
    const float part = 1.0f / static_cast<float>(count);
    const float y = pair.y + static_cast<float>(index) * part;
    return {std::min((pair.x + static_cast<float>(index)) * part, 1.0f - 0x1p-24f), y < 1.0f ? y : y - 1.0f};
}

}  // namespace

Arrival PathTracer::arrive(ClosestHit& found, std::vector<LightRay>& light_rays) {
    if (has_departed_) add_blocked_lights();
    take_hit(found);
    pass_volumes();
    const double end = hit_ ? hit_->t : std::numeric_limits<double>::infinity();
    add_lamps(end);
    const int vertex = vertex_;
    if (scene_.has_media() && !media_.empty() && pass_media(end, light_rays))
        return vertex_ > vertex ? Arrival::GoesOn : Arrival::Ends;
    if (!hit_) return leave_scene() ? Arrival::InWorld : Arrival::Ends;
    material_ = &scene_.material(hit_->instance, hit_->local);
    if (scene_.has_media() && material_->bounds_medium_alone) {
        pass_boundary();
        return vertex_ < kMostVertices ? Arrival::GoesOn : Arrival::Ends;
    }
    return !bounces_.is_last() || may_shine_or_let_through() ? Arrival::AtSurface : Arrival::Ends;
}

void PathTracer::ask_numbers(SamplePairs& pairs) const {
    pairs.add(sampler_, dimension(vertex_, PathDimension::Light));
    pairs.add(sampler_, dimension(vertex_, PathDimension::Scatter));
}

ShadingInputs PathTracer::approach(Vertex& vertex) const {
    const Vec3f direction(ray_.direction);
    vertex.outgoing = -direction;
    vertex.closures.aovs = aovs();
    if (has_footprint_) vertex.differential = differential_.transferred(direction, hit_->t, vertex.point.facet_normal);
    if (hit_->is_interpolated()) {
        vertex.point.dp_du = vertex.differential.dp_dx;
        vertex.point.dp_dv = vertex.differential.dp_dy;
    }
    ShadingInputs inputs = scene_.shading_inputs(vertex.point, *material_, vertex.outgoing,
                                                 footprint_on_surface(vertex.differential), bounces_.at(hit_->t));
    scene_.offer_surroundings(inputs, {sampler_, dimension(vertex_, PathDimension::Probe)});
    return inputs;
}

bool PathTracer::look(Vertex& vertex, const Vec2f& random, std::vector<LightQuery>& wanted) {
    if (bounces_.count() == 0) record_surface(vertex);
    if (settings_.feature_passes) features_.meet(scene_, vertex, hit_->t - ray_.t_min, light_.sample);
    if (bounces_.count() == 0 && is_held_out(vertex.closures)) return false;
    add_emission(vertex);
    if (bounces_.is_spent()) return false;
    if (!bounces_.is_last()) want_lights(vertex, random, wanted);
    return true;
}

bool PathTracer::leave(Vertex& vertex, const Vec2f& random, std::span<LightQuery> lights,
                       std::vector<LightRay>& light_rays) {
    vertex.look();
    find_glints(scene_, bounces_, vertex, counts_);
    add_lights(vertex, lights, light_rays);
    const bool goes_on = go_on(vertex, random, light_rays);
    ++vertex_;
    return goes_on;
}

const PixelSample& PathTracer::finish() {
    if (settings_.surface_passes && !surface_recorded_) light_.sample[Pass::depth].x = kNoDepth;
    light_.sample[Pass::mist].x = 1.0f - light_.sample[Pass::mist].x;
    light_.finish(alpha_);
    if (settings_.catches_shadows) divide_by_catchers();
    return light_.sample;
}

void PathTracer::take_hit(ClosestHit& found) {
    if (outside_of_ != kNowhere)
        found = outside_glass(scene_, outside_of_, ray_, bounces_.ray_kind(),
                              scene_.needs_differentials() ? &differential_ : nullptr, found);
    hit_ = found.hit ? &*found.hit : nullptr;
    if (vertex_ > 0 || !settings_.ray_passes) return;
    write_answer(scene_.tracer(), found, light_.sample);
    write_level(found.hit, light_.sample);
}

void PathTracer::pass_volumes() {
    if (scene_.volumes().empty()) return;
    Ray ray = ray_;
    if (hit_) ray.t_max = hit_->t;
    const VolumePassage passage = through_volumes(scene_, ray, bounces_.ray_kind());
    if (!is_black(passage.emission)) add(passage.emission, Pass::emission, -1);
    throughput_ *= passage.transmittance;
    if (vertex_ == 0 && settings_.ray_passes) write_volumes(passage, light_.sample);
}

void PathTracer::add(const Color& radiance, Pass seen, int group) {
    const Color light = throughput_ * radiance;
    if (bounces_.count() == 0)
        light_.add_seen(seen, light, group);
    else
        light_.add_scattered(light, bounces_.count(), first_shares_, group);
}

void PathTracer::add_lamps(double t_max) {
    const LightSet& lights = scene_.lights();
    if (!lights.may_meet_lamps(ray_, t_max)) return;
    const auto add_lamp = [this](const LampHit& hit) {
        if (bounces_.count() > 0 && hit.blockers >= 0) return;
        add(hit.radiance * departure_.weight(hit.density) * free_of_media(hit.t), Pass::emission, hit.light_group);
    };
    lights.lamp_hits(ray_, t_max, departure_.from, bounces_.ray_kind(), bounces_.of_met_lamp(), add_lamp);
}

void PathTracer::add_blocked_lights() {
    has_departed_ = false;
    FreeWay way;
    way.ray = ray_;
    way.differential = differential_;
    way.kind = bounces_.ray_kind();
    way.state = bounces_.at(0);
    way.transparent_left = bounces_.transparent_left();
    way.widening = settings_.widening(importance(), false);
    way.media = media_;
    way.random = RandomStream(sampler_, dimension(vertex_, PathDimension::ShadowWalk));
    FreeWay shadow = way;
    shadow.kind = bounces_.kind_of_shadow_ray();
    shadow.state = bounces_.of_met_lamp();
    shadow.state.shadow = true;
    find_blocked_lights(scene_, way, shadow, departure_.from, [this](const BlockedLight& light) {
        ++counts_[RayUse::Shadow];
        add(light.radiance * departure_.weight(light.density), Pass::emission, light.light_group);
    });
}

bool PathTracer::leave_scene() {
    if (hides_world()) alpha_ -= average(throughput_);
    if (!scene_.shows_world_to(bounces_.ray_kind()) ||
        (hides_world() && !settings_.wants(Pass::environment) && settings_.slots == 0))
        return false;
    world_density_ =
        departure_.density > 0.0f ? scene_.lights().world_density(Vec3f(ray_.direction), departure_.from) : 0.0f;
    const Color* even = scene_.even_world();
    if (!even || !aovs().empty()) return true;
    take_world(*even);
    return false;
}

ShadingInputs PathTracer::look_at_world(Closures& closures) const {
    closures.aovs = aovs();
    // As in footprint_on_surface.
    const RayDifferential footprint = world_density_ > 0.0f ? RayDifferential{} : differential_;
    return scene_.world_inputs(Vec3f(ray_.direction), footprint, bounces_.at(0));
}

void PathTracer::take_world(const Color& radiance) {
    if (settings_.feature_passes) features_.meet_light(radiance, light_.sample);
    if (hides_world())
        light_.add_hidden_world(throughput_ * radiance);
    else
        add(radiance * departure_.weight(world_density_), Pass::environment, scene_.world_light_group());
}

void PathTracer::add_emission(const Vertex& vertex) {
    if (is_black(vertex.closures.emission)) return;
    if (bounces_.count() > 0 && !scene_.shines_openly_on(departure_.from, vertex.point.instance)) return;
    const float density =
        departure_.density > 0.0f ? scene_.lights().emitter_density(departure_.from, vertex.point) : 0.0f;
    add(vertex.closures.emission * departure_.weight(density), Pass::emission,
        scene_.light_group(vertex.point.instance));
}

void PathTracer::want_lights(Vertex& vertex, const Vec2f& random, std::vector<LightQuery>& wanted) const {
    const LightSet& lights = scene_.lights();
    vertex.lit = lit(scene_, vertex);
    if (!vertex.closures.has_smooth_lobes() || lights.empty()) return;
    const int count = bounces_.count() == 0 && lights.holds_several() ? kFirstLightRays : 1;
    for (int i = 0; i < count; ++i) {
        LightQuery& query = wanted.emplace_back();
        query.at = &vertex.lit;
        query.random = count == 1 ? random : numbers_of_part(random, i, count);
        query.time = vertex.point.time;
        if (lights.asks_path()) query.path = bounces_.of_sampled_light();
    }
}

void PathTracer::add_lights(const Vertex& vertex, std::span<LightQuery> lights, std::vector<LightRay>& light_rays) {
    const auto count = static_cast<int>(lights.size());
    for (int i = 0; i < count; ++i) {
        Maybe<LightSample>& light = lights[static_cast<size_t>(i)].light;
        if (!light) continue;
        if (bounces_.is_in_footage()) see_in_footage(*light);
        add_sampled_light(vertex, *light, {i, count}, light_rays);
    }
}

void PathTracer::add_sampled_light(const Vertex& vertex, const LightSample& light, const Sibling& sibling,
                                   std::vector<LightRay>& light_rays) {
    const bool first = bounces_.count() == 0;
    const LitLobes lit = asks_kinds(light)    ? lit_by_kind(vertex, vertex.closures, vertex.view, light)
                         : vertex.is_foreseen ? lit_as_foreseen(vertex, light, static_cast<size_t>(sibling.index))
                                              : lit_together(vertex, vertex.closures, vertex.view, light);
    if (is_black(lit.value)) return;
    // As for one light: where a program shows scattered rays other light, the weights stay those of Cycles.
    const float share = 1.0f / static_cast<float>(sibling.count);
    const float weight = weight_over_density(light.density, light.delta ? 0.0f : lit.density) * share;
    const Color arriving = throughput_ * lit.value * (light.radiance * weight);
    if (is_black(arriving)) return;
    ++counts_[RayUse::Shadow];
    LightRay& way = light_rays.emplace_back(arriving);
    way.share = share;
    way.shares = lit.shares;
    way.first = first;
    way.group = scene_.light_group(light);
    way.scatterings = bounces_.count() + 1;
    if (!set_shadow_ray(scene_, vertex.point, light, way.ray)) {
        receive(way, Color(1.0f));
        light_rays.pop_back();
        return;
    }
    way.kind = to_light(bounces_.kind_of_shadow_ray(), light.blockers);
    if (has_footprint_) {
        way.differential = shadow_differential(vertex.differential, light, kPathSiblings);
        way.widening = settings_.widening(importance(), false);
    }
    if (scene_.has_transparency() || scene_.has_media()) {
        way.state = bounces_.of_shadow_ray();
        way.transparent_left = bounces_.transparent_left();
    }
    if (!scene_.has_media()) return;
    way.media = media_;
    const uint32_t walk = dimension(vertex_, PathDimension::ShadowWalk);
    way.random = RandomStream(sampler_, walk ^ (static_cast<uint32_t>(sibling.index) << 24));
    leave_towards(scene_, vertex.point, vertex.outgoing, Vec3f(way.ray.direction), way.media);
}

void PathTracer::receive(const LightRay& from, const Color& free) {
    if (is_black(free)) return;
    if (from.first)
        light_.add_first(from.arriving * free, from.shares, from.group, from.share);
    else
        light_.add_scattered(from.arriving * free, from.scatterings, first_shares_, from.group, from.share);
}

void PathTracer::record_surface(const Vertex& vertex) {
    const Closures& closures = vertex.closures;
    alpha_ -= average(throughput_) * closures.holdout;
    if (settings_.color_passes) light_.add_albedo(albedo_by_kind(vertex, throughput_));
    if (settings_.mattes) write_matte(scene_, vertex, throughput_, light_.sample);
    if (settings_.wants(Pass::mist)) write_mist(scene_, settings_, vertex, throughput_, light_.sample);
    if (!settings_.surface_passes || surface_recorded_ || !is_opaque_enough(closures)) return;
    surface_recorded_ = true;
    write_surface(scene_, vertex, light_.sample);
    if (!settings_.wants(Pass::ambient_occlusion)) return;
    ++counts_[RayUse::Occlusion];
    const uint32_t use = dimension(vertex_, PathDimension::Occlusion);
    light_.sample.add(Pass::ambient_occlusion,
                      ambient_occlusion(scene_, settings_, vertex, {1, sampler_, use, widening()}));
}

bool PathTracer::go_on(const Vertex& vertex, const Vec2f& random, std::vector<LightRay>& light_rays) {
    const float straight = straight_probability(vertex);
    if (straight >= 1.0f) return pass_through(vertex, straight);
    Vec2f numbers = random;
    if (straight > 0.0f) {
        const float choice = this->random(PathDimension::Transparency), scattered = 1.0f - straight;
        if (choice >= scattered) return pass_through(vertex, straight);
        // One number chooses among all ways of sharp lobes. So each is taken evenly often, and one that is rare and
        // ends on a light makes little noise.
        if (!vertex.closures.has_smooth_lobes()) numbers.x = std::min(choice / scattered, 1.0f - 0x1p-24f);
    }
    if (bounces_.is_last() || vertex.closures.size() == 0) return false;
    throughput_ /= 1.0f - straight;
    return scatter(vertex, numbers, light_rays);
}

bool PathTracer::scatter(const Vertex& vertex, const Vec2f& random, std::vector<LightRay>& light_rays) {
    const Vec3f& facet = vertex.point.facet_normal;
    const uint32_t third = Sampler::joined(dimension(vertex_, PathDimension::Scatter));
    const float z = vertex.closures.needs_third_number() ? sampler_.get1(third) : 0.0f;
    const std::optional<LobeSample> sample = vertex.scatter(Vec3f(random.x, random.y, z));
    if (!sample) return false;
    if (sample->subsurface) return scatter_below(vertex, *sample, light_rays);
    if (bounces_.count() == 0 && settings_.light_passes)
        first_shares_ = shares_of_scattering(vertex, vertex.closures, *sample);
    bounces_.scatter(*sample);
    use_ = use_of_scattered(use_, *sample);
    throughput_ *= sample->weight;
    if (!survives_roulette()) return false;
    const bool enters = sample->singular && sample->transmitted && vertex.outgoing.dot(facet) > 0.0f;
    if (has_footprint_)
        differential_ = scattered_differential(vertex.differential, -vertex.outgoing, vertex.point, *sample);
    departure_ = {sample->singular ? 0.0f : sample->density, vertex.lit};
    has_departed_ = scene_.has_blocked_lights();
    leave_towards(scene_, vertex.point, vertex.outgoing, sample->direction, media_);
    ray_ = kNewRay;
    vertex.point.release(ray_, ray_direction(sample->direction));
    outside_of_ = kNowhere;
    if (!enters) return true;
    const GlassOutcome crossing =
        cross_glass(scene_, *hit_, vertex, settings_.most_interior_hits, {ray_, differential_, bounces_, throughput_});
    if (crossing == GlassOutcome::Left) {
        departure_.from.position = ray_.origin;
        outside_of_ = vertex.point.instance;
    }
    return crossing != GlassOutcome::Ended;
}

bool PathTracer::scatter_below(const Vertex& vertex, const LobeSample& entry, std::vector<LightRay>& light_rays) {
    std::optional<SubsurfaceVertex> exit =
        leave_below(scene_, {vertex, entry, bounces_.at(0), sampler_, dimension(vertex_, PathDimension::Walk)});
    if (!exit) return false;
    throughput_ *= exit->throughput;
    if (!(max_abs(throughput_) > 0.0f) || !is_finite(throughput_)) return false;
    ++vertex_;
    std::vector<LightQuery> lights;
    want_lights(exit->vertex, random2(PathDimension::Light), lights);
    scene_.lights().sample(lights);
    add_lights(exit->vertex, lights, light_rays);
    return scatter(exit->vertex, random2(PathDimension::Scatter), light_rays);
}

bool PathTracer::survives_roulette() {
    const float largest = max_abs(throughput_);
    if (!(largest > 0.0f) || !is_finite(throughput_)) return false;
    if (bounces_.count() <= settings_.roulette_start) return true;
    // By the root: what survives by the throughput itself is so bright that clamping takes it away.
    const float survival = std::clamp(std::sqrt(largest), kLeastSurvival, 1.0f);
    if (random(PathDimension::Roulette) >= survival) return false;
    throughput_ /= survival;
    return true;
}

}  // namespace rayleaf
