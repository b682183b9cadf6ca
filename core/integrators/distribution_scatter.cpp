#include "integrators/distribution_tracer.h"
#include "integrators/glass_path.h"
#include "integrators/portals.h"
#include "integrators/scattered_differential.h"
#include "integrators/shadow.h"

#include <array>

namespace rayleaf {

void DistributionTracer::send_on(const Branch& branch, const Hit& hit, const Vertex& vertex) {
    const SplitClosures lobes(vertex.closures, vertex.outgoing, vertex.point.facet_normal);
    sample_lights(branch, vertex, lobes);
    follow_singular(branch, hit, vertex, lobes);
    scatter_glossy(branch, vertex, lobes);
    scatter_over_hemisphere(branch, vertex, lobes);
    scatter_below(branch, vertex, lobes);
}

bool DistributionTracer::send_on_way(const Branch& branch, const Vertex& vertex, const LightSample& light,
                                     int siblings) {
    FreeWay& way = light_ways_.emplace_back();
    if (!set_shadow_ray(scene_, vertex.point, light, way.ray)) {
        light_ways_.pop_back();
        return false;
    }
    way.kind = to_light(kVisibleShadow, light.blockers);
    if (has_footprint_) {
        way.differential = shadow_differential(vertex.differential, light, siblings);
        way.widening = settings_.widening(branch.importance(), false);
    }
    if (scene_.has_transparency() || scene_.has_media()) {
        way.state = branch.bounces.of_shadow_ray();
        way.transparent_left = branch.bounces.transparent_left();
    }
    if (!scene_.has_media()) return true;
    way.media = branch.media;
    way.random = RandomStream(branch.sampler, dimension(branch.vertex, PathDimension::ShadowWalk));
    leave_towards(scene_, vertex.point, vertex.outgoing, Vec3f(way.ray.direction), way.media);
    return true;
}

void DistributionTracer::send_light(const Branch& branch, const Vertex& vertex, const LightSample& light,
                                    const Color& value, const ByKind& shares, int count) {
    const float each = 1.0f / static_cast<float>(count);
    const Color arriving = branch.throughput * value * (light.radiance / light.density) * each;
    if (is_black(arriving)) return;
    ++(*counts_)[RayUse::Shadow];
    const int siblings = branch.spread == Spread::One ? kPathSiblings : count;
    const bool waits = send_on_way(branch, vertex, light, siblings);
    const int scatterings = branch.bounces.count() + 1;
    sent_.push_back({arriving, scatterings == 1 ? shares : branch.first_shares, scene_.light_group(light), scatterings,
                     branch.share * each, waits});
    if (sent_.size() == kPacketSize) receive_light_alone();
}

void DistributionTracer::receive_light_alone() {
    std::array<Color, kPacketSize> free;
    free_shares(scene_, light_ways_, Coherence::Coherent, free.data());
    receive_light(free.data());
}

void DistributionTracer::receive_light(const Color* free) {
    for (const SentLight& light : sent_) {
        const Color arriving = light.waits ? light.value * *free++ : light.value;
        if (is_black(arriving)) continue;
        if (light.scatterings == 1)
            light_.add_first(arriving, light.shares, light.group, light.share);
        else
            light_.add_scattered(arriving, light.scatterings, light.shares, light.group, light.share);
    }
    sent_.clear();
    light_ways_.clear();
}

LitClasses DistributionTracer::lit_by_classes(const Branch& branch, const Vertex& vertex, const SplitClosures& lobes,
                                              const LightSample& light, int count) const {
    const bool kinds = (branch.bounces.count() == 0 && settings_.light_passes) || !lights_all_kinds(light);
    const auto lit = [&](const Closures& closures, const ClosureView& view) {
        if (closures.size() == 0) return LitLobes{};
        return kinds ? lit_by_kind(vertex, closures, view, light) : lit_together(vertex, closures, view, light);
    };
    // Hemisphere rays leave sampled light to light sampling; with ambient occlusion, it leaves the world to them.
    const bool occluded_world = light.world && distribution_.indirect == IndirectLight::AmbientOcclusion;
    const LitLobes diffuse = occluded_world ? LitLobes{} : lit(lobes.diffuse(), lobes.diffuse_view());
    LitLobes glossy = lit(lobes.glossy(), lobes.glossy_view());
    if (!light.delta && lobes.glossy().size() > 0) {
        const auto glossy_rays = static_cast<float>(rays(branch, distribution_.glossy_rays));
        glossy.value *= power_heuristic(static_cast<float>(count) * light.density, glossy_rays * glossy.density);
    }
    LitClasses sum{diffuse.value + glossy.value, {}};
    if (!kinds) return sum;
    ByKind parts;
    for (const LobeKind kind : kLobeKinds)
        parts[kind] = diffuse.value * diffuse.shares[kind] + glossy.value * glossy.shares[kind];
    sum.shares = shares_of(parts, sum.value);
    return sum;
}

void DistributionTracer::sample_lights(const Branch& branch, const Vertex& vertex, const SplitClosures& lobes) {
    if (scene_.lights().empty() || lobes.diffuse().size() + lobes.glossy().size() == 0) return;
    const int count = rays(branch, distribution_.light_rays);
    const uint32_t use = dimension(branch.vertex, PathDimension::Light);
    LitPoint at = lit(scene_, vertex);
    const PathState path = branch.bounces.of_sampled_light();
    std::vector<LightQuery> queries;
    queries.reserve(static_cast<size_t>(count));
    for (int i = 0; i < count; ++i) {
        const Sampler sampler = branch.sampler.branch(static_cast<uint32_t>(i), static_cast<uint32_t>(count), use);
        queries.push_back({&at, sampler.get2(use), vertex.point.time, path, {}});
    }
    scene_.lights().sample(queries);
    for (const LightQuery& query : queries) {
        if (!query.light) continue;
        const LitClasses lit = lit_by_classes(branch, vertex, lobes, *query.light, count);
        send_light(branch, vertex, *query.light, lit.value, lit.shares, count);
    }
}

void DistributionTracer::follow_singular(const Branch& branch, const Hit& hit, const Vertex& vertex,
                                         const SplitClosures& lobes) {
    uint32_t number = 0;
    float total = max_component(vertex.closures.unscattered());
    for (const LobeSample& sample : lobes.singular()) total += max_component(sample.weight);
    for (const LobeSample& sample : lobes.singular()) {
        Branch child = branch.scattered(scene_, vertex, vertex.closures, sample, 1);
        child.sampler = branch.sampler.branch(0, 1, dimension(branch.vertex, PathDimension::Child) ^ (number++ << 24));
        if (has_footprint_)
            child.differential = glossy_differential(vertex.differential, -vertex.outgoing, vertex.point, sample, 1);
        child.use = RayUse::Specular;
        child.shows_features = branch.shows_features;
        child.features.take_share(max_component(sample.weight) / total);
        push_scattered(std::move(child), hit, vertex, sample);
    }
}

void DistributionTracer::scatter_glossy(const Branch& branch, const Vertex& vertex, const SplitClosures& lobes) {
    if (lobes.glossy().size() == 0) return;
    const int count = rays(branch, distribution_.glossy_rays);
    const uint32_t use = dimension(branch.vertex, PathDimension::Scatter);
    for (int i = 0; i < count; ++i) {
        const Sampler sampler = branch.sampler.branch(static_cast<uint32_t>(i), static_cast<uint32_t>(count), use);
        const std::optional<LobeSample> sample =
            lobes.glossy().sample(lobes.glossy_view(), vertex.point.facet_normal, sampler.get3(use));
        if (!sample) continue;
        Branch child = branch.scattered(scene_, vertex, lobes.glossy(), *sample, count);
        child.sampler = sampler;
        if (has_footprint_)
            child.differential =
                glossy_differential(vertex.differential, -vertex.outgoing, vertex.point, *sample, count);
        child.departure.sampling = LightSampling::Weighed;
        child.departure.density = static_cast<float>(count) * sample->density;
        child.departure.light_rays = static_cast<float>(rays(branch, distribution_.light_rays));
        child.use = RayUse::Glossy;
        push(std::move(child), vertex);
    }
}

void DistributionTracer::sample_light_once(const Branch& branch, const Vertex& vertex) {
    if (!vertex.closures.has_smooth_lobes() || scene_.lights().empty()) return;
    const Maybe<LightSample> light =
        scene_.lights().sample(lit(scene_, vertex), branch.sampler.get2(dimension(branch.vertex, PathDimension::Light)),
                               vertex.point.time, branch.bounces.of_sampled_light());
    if (!light) return;
    const LitLobes lit = !lights_all_kinds(*light) ? lit_by_kind(vertex, vertex.closures, vertex.view, *light)
                                                   : lit_together(vertex, vertex.closures, vertex.view, *light);
    const float weight = light->delta ? 1.0f : power_heuristic(light->density, lit.density);
    send_light(branch, vertex, *light, lit.value * weight, {}, 1);
}

void DistributionTracer::send_one_on(const Branch& branch, const Hit& hit, const Vertex& vertex) {
    const bool last = branch.bounces.is_last();
    if (!last) sample_light_once(branch, vertex);
    const float through = max_component(vertex.closures.unscattered());
    float scattering = 0.0f;
    for (int i = 0; i < vertex.closures.size() && !last; ++i) scattering += max_component(vertex.closures[i].weight);
    const float straight = through > 0.0f ? through / (through + scattering) : 0.0f;
    if (straight > 0.0f && branch.random(PathDimension::Transparency) < straight) {
        const float portal = portal_share(vertex.closures);
        if (portal > 0.0f && branch.random(PathDimension::Portal) < portal) {
            Branch child = branch.by_portal(scene_, vertex);
            child.throughput /= straight * portal;
            return push(std::move(child));
        }
        Branch child = branch.straight_on(scene_, vertex);
        child.throughput /= straight * (1.0f - portal);
        return push(std::move(child), vertex);
    }
    if (!last) scatter_once(branch, hit, vertex, straight);
}

void DistributionTracer::scatter_once(const Branch& branch, const Hit& hit, const Vertex& vertex, float straight) {
    const std::optional<LobeSample> sample = vertex.closures.sample(
        vertex.view, vertex.point.facet_normal, branch.sampler.get3(dimension(branch.vertex, PathDimension::Scatter)));
    if (!sample) return;
    if (sample->subsurface) {
        Branch below = branch;
        below.throughput /= 1.0f - straight;
        return walk_on(std::move(below), vertex, *sample);
    }
    Branch child = branch.scattered(scene_, vertex, vertex.closures, *sample, 1);
    child.throughput /= 1.0f - straight;
    if (has_footprint_)
        child.differential = scattered_differential(vertex.differential, -vertex.outgoing, vertex.point, *sample);
    if (!sample->singular) {
        child.departure.sampling = LightSampling::Weighed;
        child.departure.density = sample->density;
    }
    child.use = RayUse::Indirect;
    push_scattered(std::move(child), hit, vertex, *sample);
}

void DistributionTracer::push_scattered(Branch&& branch, const Hit& hit, const Vertex& from, const LobeSample& sample) {
    enter_media(branch, from);
    const bool enters = sample.singular && sample.transmitted && from.outgoing.dot(from.point.facet_normal) > 0.0f;
    if (enters) {
        const GlassOutcome crossing = cross_glass(scene_, hit, from, settings_.most_interior_hits,
                                                  {branch.ray, branch.differential, branch.bounces, branch.throughput});
        if (crossing == GlassOutcome::Ended) return;
        if (crossing == GlassOutcome::Left) {
            branch.departure.from.position = branch.ray.origin;
            branch.outside_of = from.point.instance;
        }
    }
    push(std::move(branch));
}

void DistributionTracer::push(Branch&& branch) {
    if (survives(branch, settings_)) pending_.push_back(std::move(branch));
}

}  // namespace rayleaf
