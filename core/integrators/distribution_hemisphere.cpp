#include "base/sample_pairs.h"
#include "integrators/ambient_occlusion.h"
#include "integrators/distribution_tracer.h"
#include "integrators/scattered_differential.h"
#include "integrators/shadow.h"

#include <array>

namespace rayleaf {

HemisphereRay DistributionTracer::trace_hemisphere(const Branch& ray) {
    const double reach = settings_.occlusion_distance;
    const bool carries_light =
        distribution_.indirect != IndirectLight::AmbientOcclusion && hemisphere_brings_light(frame_);
    Branch& branch = branch_.emplace(ray);
    branch.ray = ray_of(ray);
    const double whole = branch.ray.t_max;
    if (!carries_light) branch.ray.t_max = reach;
    ++(*counts_)[ray.use];
    const ClosestHit found = scene_.tracer().closest(branch.ray, branch.bounces.ray_kind(), differential_of(branch));
    Ray limited = branch.ray;
    const Maybe<Hit>& hit = found.hit;
    HemisphereRay result;
    if (hit) result.inverse_distance = static_cast<float>(1.0 / hit->t);
    limited.t_max = reach;
    const bool nothing_near = !hit || hit->t > reach;
    if (nothing_near && scene_.volumes().empty())
        result.light.free = Color(1.0f);
    else if (scene_.has_transparency() || !scene_.volumes().empty())
        result.light.free = free_share(scene_, way_of(ray, limited));
    if (carries_light) {
        branch.ray.t_max = whole;
        arrive_alone(found);
        follow_pending();
        const auto color = [&](Pass pass) {
            const Vec4f& value = light_.sample[pass];
            return Color(value.x, value.y, value.z);
        };
        result.light.direct = color(Pass::diffuse_direct);
        result.light.indirect = color(Pass::diffuse_indirect);
    } else if (distribution_.indirect == IndirectLight::AmbientOcclusion && scene_.shows_world_to(kVisibleDiffuse)) {
        result.light.direct =
            result.light.free * scene_.world(Vec3f(ray.ray.direction), ray.differential, ray.bounces.at(0));
    }
    return result;
}

void DistributionTracer::add_occlusion(const Branch& branch, const Vertex& vertex) {
    if (frame_.cache) {
        const std::optional<HemisphereLight> cached =
            frame_.cache->interpolate(vertex.point.position, facing_normal(vertex));
        if (cached) return light_.sample.add(Pass::ambient_occlusion, cached->free / kPi);
    }
    const int count = rays(branch, distribution_.hemisphere_rays);
    (*counts_)[RayUse::Occlusion] += static_cast<uint64_t>(count);
    const uint32_t use = dimension(branch.vertex, PathDimension::Occlusion);
    light_.sample.add(Pass::ambient_occlusion,
                      ambient_occlusion(scene_, settings_, vertex, {count, branch.sampler, use, widening(branch)}));
}

void DistributionTracer::scatter_over_hemisphere(const Branch& branch, const Vertex& vertex,
                                                 const SplitClosures& lobes) {
    if (lobes.diffuse().size() == 0 || !hemisphere_brings_light(frame_)) return;
    if (frame_.cache && add_cached_hemisphere(branch, vertex, lobes.diffuse())) {
        ++counts_->hemispheres_interpolated;
        return;
    }
    ++counts_->hemispheres_sampled;
    const int count = rays(branch, distribution_.hemisphere_rays);
    const uint32_t use = dimension(branch.vertex, PathDimension::Hemisphere);
    constexpr int kAtOnce = SamplePairs::kMost / 2;
    for (int first = 0; first < count; first += kAtOnce) {
        const int end = std::min(first + kAtOnce, count);
        const auto sampler_of = [&](int i) {
            return branch.sampler.branch(static_cast<uint32_t>(i), static_cast<uint32_t>(count), use);
        };
        SamplePairs pairs;
        for (int i = first; i < end; ++i) pairs.add3(sampler_of(i), use);
        pairs.compute();
        for (int i = first; i < end; ++i) {
            const std::optional<LobeSample> sample = lobes.diffuse().sample(
                lobes.diffuse_view(), vertex.point.facet_normal, pairs.triple(2 * static_cast<size_t>(i - first)));
            if (!sample) continue;
            const HemisphereSample chosen{*sample, sampler_of(i), count};
            if (distribution_.indirect == IndirectLight::AmbientOcclusion)
                ask_world(branch, vertex, lobes.diffuse(), chosen);
            else
                send_over_hemisphere(branch, vertex, lobes.diffuse(), chosen);
        }
    }
}

void DistributionTracer::send_over_hemisphere(const Branch& branch, const Vertex& vertex, const Closures& lobes,
                                              const HemisphereSample& chosen) {
    const LobeSample& sample = chosen.sample;
    Branch child = branch.scattered(scene_, vertex, lobes, sample, chosen.count);
    child.sampler = chosen.sampler;
    if (has_footprint_)
        child.differential =
            hemisphere_differential(vertex.differential, sample.direction, kPi * sample.density, chosen.count);
    child.departure.sampling = LightSampling::Alone;
    child.spread = Spread::One;
    child.use = RayUse::Hemisphere;
    push(std::move(child), vertex);
}

/// As the branch that it would be, without all that only a ray that goes on needs.
void DistributionTracer::ask_world(const Branch& branch, const Vertex& vertex, const Closures& lobes,
                                   const HemisphereSample& chosen) {
    if (world_rays_.size() == kPacketSize) receive_world_alone();
    ++(*counts_)[RayUse::Hemisphere];
    const LobeSample& sample = chosen.sample;
    const auto count = static_cast<float>(chosen.count);
    Bounces bounces = branch.bounces;
    bounces.scatter(sample);
    FreeWay& way = world_ways_.emplace_back();
    vertex.point.release(way.ray, ray_direction(sample.direction));
    way.ray.t_max = settings_.occlusion_distance;
    way.kind = bounces.ray_kind();
    way.state = bounces.at(0);
    way.transparent_left = bounces.transparent_left();
    if (scene_.has_media()) {
        way.media = branch.media;
        leave_towards(scene_, vertex.point, vertex.outgoing, sample.direction, way.media);
        way.random = RandomStream(chosen.sampler, dimension(branch.vertex + 1, PathDimension::ShadowWalk));
    }

    WorldRay& ray = world_rays_.emplace_back();
    ray.throughput = branch.throughput * (sample.weight / count);
    ray.share = branch.share / count;
    ray.direction = sample.direction;
    ray.kind = way.kind;
    ray.state = way.state;
    ray.scatterings = bounces.count();
    ray.first_shares = branch.splits_light && branch.bounces.count() == 0 ? shares_of_scattering(vertex, lobes, sample)
                                                                          : branch.first_shares;
    if (!has_footprint_) return;
    ray.differential =
        hemisphere_differential(vertex.differential, sample.direction, kPi * sample.density, chosen.count);
    way.differential = ray.differential;
    way.widening = settings_.widening(max_abs(ray.throughput) / ray.share, true);
}

void DistributionTracer::receive_world_alone() {
    std::array<Color, kPacketSize> free;
    free_shares(scene_, world_ways_, Coherence::Incoherent, free.data());
    receive_world(free.data());
}

void DistributionTracer::receive_world(const Color* free) {
    for (const WorldRay& ray : world_rays_) {
        const Color share = *free++;
        if (is_black(share) || !scene_.shows_world_to(ray.kind)) continue;
        const Color radiance = scene_.world(ray.direction, ray.differential, ray.state);
        light_.add_scattered(ray.throughput * (share * radiance), ray.scatterings, ray.first_shares,
                             scene_.world_light_group(), ray.share);
    }
    world_rays_.clear();
    world_ways_.clear();
}

bool DistributionTracer::add_cached_hemisphere(const Branch& branch, const Vertex& vertex, const Closures& lobes) {
    ByKind direct, indirect;
    Color direct_sum(0.0f), indirect_sum(0.0f);
    for (int i = 0; i < lobes.size(); ++i) {
        const Lobe& lobe = lobes[i];
        const bool far_side = lobe.type == LobeType::Translucent;
        const std::optional<HemisphereLight> light =
            frame_.cache->interpolate(vertex.point.position, far_side ? -lobe.normal : lobe.normal);
        if (!light) return false;
        const Color factor = branch.throughput * hemispherical_albedo(lobe, vertex.outgoing) / kPi;
        direct[lobe.kind] += factor * light->direct;
        indirect[lobe.kind] += factor * light->indirect;
        direct_sum += factor * light->direct;
        indirect_sum += factor * light->indirect;
    }
    constexpr int kNoGroup = -1;  // the cache holds the light of all groups together
    const int count = branch.bounces.count();
    const bool first = count == 0;
    light_.add_scattered(direct_sum, count + 1, first ? shares_of(direct, direct_sum) : branch.first_shares, kNoGroup,
                         branch.share);
    light_.add_scattered(indirect_sum, count + 2, first ? shares_of(indirect, indirect_sum) : branch.first_shares,
                         kNoGroup, branch.share);
    return true;
}

}  // namespace rayleaf
