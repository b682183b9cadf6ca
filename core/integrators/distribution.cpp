#include "integrators/distribution.h"

#include "integrators/blocked_light.h"
#include "integrators/distribution_tracer.h"
#include "integrators/first_surface.h"
#include "integrators/glass_path.h"
#include "integrators/ray_passes.h"

namespace rayleaf {

void DistributionTracer::write_extras(SampleExtras& extras) {
    extras.clear(settings_.slots);
    light_.sample.extras = &extras;
}

void DistributionTracer::begin(const CameraRay& camera_ray, const Sampler& sampler) {
    light_.sample.clear();
    alpha_ = 1;
    surface_recorded_ = false;
    pending_.clear();
    if (!camera_ray.exists) return;
    Branch& camera = pending_.emplace_back(settings_, camera_ray, sampler);
    if (scene_.has_media()) camera.media = media_around(scene_, camera.ray.at(camera.ray.t_min), camera.ray.time);
}

RayQuery DistributionTracer::next_ray() {
    branch_.emplace(std::move(pending_.back()));
    pending_.pop_back();
    ++(*counts_)[branch_->use];
    if (has_footprint_) branch_->ray = ray_of(*branch_);
    return {&branch_->ray, branch_->bounces.ray_kind(), differential_of(*branch_)};
}

void DistributionTracer::leave_glass(Branch& branch, ClosestHit& found) const {
    if (branch.outside_of == RayAnchor::kNone) return;
    found = outside_glass(scene_, branch.outside_of, branch.ray, branch.bounces.ray_kind(), differential_of(branch),
                          std::move(found));
}

const PixelSample& DistributionTracer::trace_alone() {
    follow_pending();
    return finish();
}

void DistributionTracer::follow_pending() {
    while (goes_on()) {
        const RayQuery query = next_ray();
        arrive_alone(scene_.tracer().closest(*query.ray, query.kind, query.differential));
    }
}

void DistributionTracer::arrive_alone(const ClosestHit& found) {
    if (arrive(found)) {
        Vertex vertex;
        vertex.point = scene_.tracer().surface_point(branch_->ray, *hit_);
        scene_.material(hit_->instance, hit_->local).surface->evaluate(approach(vertex), vertex.closures);
        shade(vertex);
    }
    receive_light_alone();
    receive_world_alone();
}

const PixelSample& DistributionTracer::finish() {
    if (settings_.surface_passes && !surface_recorded_) light_.sample[Pass::depth].x = kNoDepth;
    light_.sample[Pass::mist].x = 1.0f - light_.sample[Pass::mist].x;
    light_.finish(alpha_);
    return light_.sample;
}

void DistributionTracer::pass_volumes(Branch& branch, const Maybe<Hit>& hit) {
    Ray ray = ray_of(branch);
    if (hit) ray.t_max = hit->t;
    const VolumePassage passage = through_volumes(scene_, ray, branch.bounces.ray_kind());
    if (!is_black(passage.emission)) add(branch, passage.emission, Pass::emission, -1);
    branch.throughput *= passage.transmittance;
    if (branch.vertex == 0 && settings_.ray_passes) write_volumes(passage, light_.sample);
}

bool DistributionTracer::arrive(ClosestHit found) {
    Branch& branch = *branch_;
    leave_glass(branch, found);
    hit_ = found.hit;
    const Maybe<Hit>& hit = hit_;
    if (branch.vertex == 0 && settings_.ray_passes) {
        write_answer(scene_.tracer(), found, light_.sample);
        write_level(hit, light_.sample);
    }
    if (branch.has_departed) add_blocked_lights(branch);
    if (!scene_.volumes().empty()) pass_volumes(branch, hit);
    const double end = hit ? hit->t : std::numeric_limits<double>::infinity();
    add_lamps(branch, end);
    if (!branch.media.empty() && pass_media(branch, end)) return false;
    if (!hit) {
        add_world(branch);
        return false;
    }
    const Material& material = scene_.material(hit->instance, hit->local);
    if (material.bounds_medium_alone) {
        pass_boundary(branch, *hit);
        return false;
    }
    const Program& program = *material.surface;
    return !branch.bounces.is_last() || program.emits() || program.may_be_transparent();
}

ShadingInputs DistributionTracer::approach(Vertex& vertex) {
    const Branch& branch = *branch_;
    const Vec3f direction(branch.ray.direction);
    vertex.outgoing = -direction;
    if (has_footprint_)
        vertex.differential = branch.differential.transferred(direction, hit_->t, vertex.point.facet_normal);
    if (hit_->is_interpolated()) {
        vertex.point.dp_du = vertex.differential.dp_dx;
        vertex.point.dp_dv = vertex.differential.dp_dy;
    }
    vertex.closures.aovs = aovs(branch);
    // Light sampling looks at points: where it might have found the same emission, both must see it alike, or their
    // weights would not add up to one.
    const Material& material = scene_.material(hit_->instance, hit_->local);
    const bool sampled = branch.departure.sampling != LightSampling::None && material.surface->emits();
    ShadingInputs inputs =
        scene_.shading_inputs(vertex.point, material, vertex.outgoing,
                              sampled ? RayDifferential{} : vertex.differential, branch.bounces.at(hit_->t));
    scene_.offer_surroundings(inputs, {branch.sampler, dimension(branch.vertex, PathDimension::Probe)});
    return inputs;
}

void DistributionTracer::shade(Vertex& vertex) {
    Branch& branch = *branch_;
    branch.bounces.simplify(vertex.closures);
    if (branch.bounces.count() == 0) record_surface(branch, vertex);
    if (settings_.feature_passes && branch.shows_features)
        branch.features.meet(scene_, vertex, hit_->t - branch.ray.t_min, light_.sample);
    if (branch.bounces.count() == 0 && is_held_out(vertex.closures)) return;
    add_emission(branch, vertex);
    if (branch.bounces.is_spent()) return;
    if (branch.spread == Spread::One) {
        vertex.look();
        return send_one_on(branch, *hit_, vertex);
    }
    if (!is_black(vertex.closures.transparency)) push(branch.straight_on(scene_, vertex), vertex);
    if (!is_black(vertex.closures.portal.weight)) push(branch.by_portal(scene_, vertex));
    if (!branch.bounces.is_last()) send_on(branch, *hit_, vertex);
}

void DistributionTracer::add(const Branch& branch, const Color& radiance, Pass seen, int group) {
    const Color light = branch.throughput * radiance;
    if (branch.bounces.count() == 0)
        light_.add_seen(seen, light, group);
    else
        light_.add_scattered(light, branch.bounces.count(), branch.first_shares, group, branch.share);
}

void DistributionTracer::add_lamps(const Branch& branch, double t_max) {
    if (branch.departure.sampling == LightSampling::Alone) return;
    const LightSet& lights = scene_.lights();
    if (!lights.may_meet_lamps(branch.ray, t_max)) return;
    const auto add_lamp = [&](const LampHit& hit) {
        if (branch.bounces.count() > 0 && hit.blockers >= 0) return;
        add(branch, hit.radiance * branch.departure.weight(hit.density) * free_of_media(branch, hit.t), Pass::emission,
            hit.light_group);
    };
    lights.lamp_hits(branch.ray, t_max, branch.departure.from, branch.bounces.ray_kind(), branch.bounces.of_met_lamp(),
                     add_lamp);
}

void DistributionTracer::add_blocked_lights(const Branch& branch) {
    if (branch.departure.sampling == LightSampling::Alone) return;
    const FreeWay way = way_of(branch, branch.ray);
    FreeWay shadow = way;
    shadow.kind = kVisibleShadow;
    shadow.state = branch.bounces.of_met_lamp();
    shadow.state.shadow = true;
    shadow.widening = settings_.widening(branch.importance(), false);
    find_blocked_lights(scene_, way, shadow, branch.departure.from, [&](const BlockedLight& light) {
        ++(*counts_)[RayUse::Shadow];
        add(branch, light.radiance * branch.departure.weight(light.density), Pass::emission, light.light_group);
    });
}

void DistributionTracer::add_world(const Branch& branch) {
    const bool hidden = branch.bounces.sees_film();
    if (hidden) alpha_ -= average(branch.throughput);
    if (!scene_.shows_world_to(branch.bounces.ray_kind()) ||
        (hidden && !settings_.wants(Pass::environment) && settings_.slots == 0))
        return;
    const Vec3f direction(branch.ray.direction);
    const BranchDeparture& departure = branch.departure;
    const float density =
        departure.sampling != LightSampling::None ? scene_.lights().world_density(direction, departure.from) : 0.0f;
    const float weight = departure.weight(density);
    if (weight == 0.0f) return;
    // As for surfaces that emit.
    const RayDifferential footprint = density > 0.0f ? RayDifferential{} : branch.differential;
    const Color radiance = scene_.world(direction, footprint, branch.bounces.at(0), aovs(branch));
    if (settings_.feature_passes && branch.shows_features) {
        DenoisingFeatures features = branch.features;
        features.meet_light(radiance, light_.sample);
    }
    if (hidden)
        light_.add_hidden_world(branch.throughput * radiance);
    else
        add(branch, radiance * weight, Pass::environment, scene_.world_light_group());
}

void DistributionTracer::add_emission(const Branch& branch, const Vertex& vertex) {
    if (is_black(vertex.closures.emission)) return;
    const BranchDeparture& departure = branch.departure;
    if (branch.bounces.count() > 0 && !scene_.shines_openly_on(departure.from, vertex.point.instance)) return;
    const float density = departure.sampling != LightSampling::None
                              ? scene_.lights().emitter_density(departure.from, vertex.point)
                              : 0.0f;
    add(branch, vertex.closures.emission * departure.weight(density), Pass::emission,
        scene_.light_group(vertex.point.instance));
}

void DistributionTracer::record_surface(const Branch& branch, const Vertex& vertex) {
    alpha_ -= average(branch.throughput) * vertex.closures.holdout;
    if (settings_.color_passes) light_.add_albedo(albedo_by_kind(vertex, branch.throughput));
    if (settings_.mattes) write_matte(scene_, vertex, branch.throughput, light_.sample);
    if (settings_.wants(Pass::mist)) write_mist(scene_, settings_, vertex, branch.throughput, light_.sample);
    if (!settings_.surface_passes || surface_recorded_ || !is_opaque_enough(vertex.closures)) return;
    surface_recorded_ = true;
    write_surface(scene_, vertex, light_.sample);
    if (settings_.wants(Pass::ambient_occlusion)) add_occlusion(branch, vertex);
}

DistributionSettings::DistributionSettings(const Settings& settings)
    : path(settings),
      glossy_rays(settings.glossy_rays),
      light_rays(settings.light_rays),
      hemisphere_rays(settings.hemisphere_rays),
      indirect(settings.indirect) {
    path.diffuse_bounces = std::min(path.diffuse_bounces, indirect == IndirectLight::ColorBleeding ? 1 : 0);
}

PixelSample trace_distributed(const DistributionFrame& frame, const CameraRay& camera_ray, const Sampler& sampler,
                              RayCounts& counts, SampleExtras* extras) {
    DistributionTracer tracer(frame, counts);
    tracer.begin(camera_ray, sampler);
    if (extras) tracer.write_extras(*extras);
    return tracer.trace_alone();
}

HemisphereRay trace_hemisphere_ray(const DistributionFrame& frame, const Branch& ray, RayCounts& counts) {
    return DistributionTracer(frame, counts).trace_hemisphere(ray);
}

bool hemisphere_brings_light(const DistributionFrame& frame) {
    const IndirectLight indirect = frame.settings.indirect;
    const bool sees_world =
        frame.scene.has_world() && (indirect == IndirectLight::AmbientOcclusion ||
                                    !(frame.scene.lights().world_density(Vec3f(0, 0, 1), {}) > 0.0f));
    return sees_world || (indirect == IndirectLight::ColorBleeding && frame.settings.path.diffuse_bounces > 0);
}

}  // namespace rayleaf
