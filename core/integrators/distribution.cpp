#include "integrators/distribution.h"

#include "integrators/ambient_occlusion.h"
#include "integrators/branch.h"
#include "integrators/dimensions.h"
#include "integrators/first_surface.h"
#include "integrators/scattered_differential.h"
#include "integrators/shadow.h"
#include "shading/split_closures.h"

namespace rayleaf {
namespace {

/// What both classes of rough lobes make of a sampled light.
struct LitClasses {
    Color value{0, 0, 0};
    ByKind shares;
};

class DistributionTracer {
  public:
    DistributionTracer(const Scene& scene, const DistributionSettings& settings, const CameraRay& camera_ray,
                       const Sampler& sampler, RayCounts& counts)
        : scene_(scene), distribution_(settings), settings_(settings.path), counts_(counts), light_(settings.path) {
        pending_.emplace_back(settings_, camera_ray, sampler);
    }

    PixelSample trace();

  private:
    const Scene& scene_;
    const DistributionSettings& distribution_;
    const PathSettings& settings_;
    RayCounts& counts_;
    Contributions light_;
    std::vector<Branch> pending_;  ///< last in, first out
    float alpha_ = 1;
    bool surface_recorded_ = false;

    void follow(const Branch& branch);
    /// Records light that a ray met, before its throughput; `seen` is its pass where the camera sees it.
    void add(const Branch& branch, const Color& radiance, Pass seen);
    void add_lamps(const Branch& branch, double t_max);
    void add_world(const Branch& branch);
    void add_emission(const Branch& branch, const Vertex& vertex);
    void record_surface(const Branch& branch, const Vertex& vertex);

    /// Number of rays of a kind of which `wanted` are set.
    int rays(const Branch& branch, int wanted) const {
        return branch.spread == Spread::One
                   ? 1
                   : std::max(1, static_cast<int>(std::lround(static_cast<float>(wanted) * branch.share)));
    }
    void send_on(const Branch& branch, const Vertex& vertex);
    void add_light(const Branch& branch, const Vertex& vertex, const LightSample& light, const Color& value,
                   const ByKind& shares, int count);
    LitClasses lit_by_classes(const Branch& branch, const Vertex& vertex, const SplitClosures& lobes,
                              const LightSample& light, int count) const;
    void sample_lights(const Branch& branch, const Vertex& vertex, const SplitClosures& lobes);
    void follow_singular(const Branch& branch, const Vertex& vertex, const SplitClosures& lobes);
    void scatter_glossy(const Branch& branch, const Vertex& vertex, const SplitClosures& lobes);
    void scatter_over_hemisphere(const Branch& branch, const Vertex& vertex, const SplitClosures& lobes);
    void add_unoccluded_world(const Branch& child);
    bool hemisphere_brings_light() const;

    void sample_light_once(const Branch& branch, const Vertex& vertex);
    void send_one_on(const Branch& branch, const Vertex& vertex);

    /// Takes a ray up, unless it is black or, being dim, ends by chance.
    void push(Branch&& branch);
};

PixelSample DistributionTracer::trace() {
    while (!pending_.empty()) {
        const Branch branch = pending_.back();
        pending_.pop_back();
        follow(branch);
    }
    if (settings_.surface_passes && !surface_recorded_) light_.sample[Pass::depth].x = kNoDepth;
    light_.finish(settings_.film_transparent ? alpha_ : 1.0f);
    return light_.sample;
}

void DistributionTracer::follow(const Branch& branch) {
    ++counts_[branch.use];
    const std::optional<Hit> hit = scene_.tracer().closest_hit(branch.ray, branch.bounces.ray_kind());
    add_lamps(branch, hit ? hit->t : std::numeric_limits<double>::infinity());
    if (!hit) return add_world(branch);
    const Program& program = *scene_.material(hit->instance, hit->local).surface;
    if (branch.bounces.is_last() && !program.emits() && !program.may_be_transparent()) return;
    Vertex vertex;
    vertex.point = scene_.tracer().surface_point(branch.ray, *hit);
    const Vec3f direction(branch.ray.direction);
    vertex.outgoing = -direction;
    vertex.differential = branch.differential.transferred(direction, hit->t, vertex.point.facet_normal);
    // Light sampling looks at points: where it might have found the same emission, both must see it alike, or their
    // weights would not add up to one.
    const bool sampled = branch.departure.sampling != LightSampling::None && program.emits();
    scene_.shade(vertex.point, vertex.outgoing, sampled ? RayDifferential{} : vertex.differential,
                 branch.bounces.at(hit->t), vertex.closures);
    if (branch.bounces.count() == 0) record_surface(branch, vertex);
    add_emission(branch, vertex);
    if (branch.bounces.is_spent()) return;
    if (branch.spread == Spread::One) return send_one_on(branch, vertex);
    if (!is_black(vertex.closures.transparency)) push(branch.straight_on(vertex));
    if (!branch.bounces.is_last()) send_on(branch, vertex);
}

void DistributionTracer::add(const Branch& branch, const Color& radiance, Pass seen) {
    const Color light = branch.throughput * radiance;
    if (branch.bounces.count() == 0)
        light_.add_seen(seen, light);
    else
        light_.add_scattered(light, branch.bounces.count(), branch.first_shares, branch.share);
}

void DistributionTracer::add_lamps(const Branch& branch, double t_max) {
    if (!scene_.lights().has_hittable_lamps() || branch.departure.sampling == LightSampling::Alone) return;
    Ray ray = branch.ray;
    ray.t_max = t_max;
    scene_.lights().lamp_hits(ray, branch.departure.position, branch.bounces.ray_kind(), [&](const LampHit& hit) {
        add(branch, hit.radiance * branch.departure.weight(hit.density), Pass::emission);
    });
}

void DistributionTracer::add_world(const Branch& branch) {
    const bool hidden = branch.bounces.count() == 0 && settings_.film_transparent;
    if (hidden) alpha_ -= average(branch.throughput);
    if (!scene_.has_world() || (hidden && !settings_.wants(Pass::environment))) return;
    const Vec3f direction(branch.ray.direction);
    const Departure& departure = branch.departure;
    const float density =
        departure.sampling != LightSampling::None ? scene_.lights().world_density(direction, departure.position) : 0.0f;
    const float weight = departure.weight(density);
    if (weight == 0.0f) return;
    // As for surfaces that emit.
    const RayDifferential footprint = density > 0.0f ? RayDifferential{} : branch.differential;
    const Color radiance = scene_.world(direction, footprint, branch.bounces.at(0));
    if (hidden)
        light_.add_hidden_world(branch.throughput * radiance);
    else
        add(branch, radiance * weight, Pass::environment);
}

void DistributionTracer::add_emission(const Branch& branch, const Vertex& vertex) {
    if (is_black(vertex.closures.emission)) return;
    const Departure& departure = branch.departure;
    const float density = departure.sampling != LightSampling::None
                              ? scene_.lights().emitter_density(departure.position, vertex.point)
                              : 0.0f;
    add(branch, vertex.closures.emission * departure.weight(density), Pass::emission);
}

void DistributionTracer::record_surface(const Branch& branch, const Vertex& vertex) {
    if (settings_.film_transparent) alpha_ -= average(branch.throughput) * vertex.closures.holdout;
    if (settings_.color_passes) light_.add_albedo(albedo_by_kind(vertex, branch.throughput));
    if (!settings_.surface_passes || surface_recorded_ || !is_opaque_enough(vertex.closures)) return;
    surface_recorded_ = true;
    write_surface(scene_, vertex, light_.sample);
    if (!settings_.wants(Pass::ambient_occlusion)) return;
    const int count = rays(branch, distribution_.hemisphere_rays);
    counts_[RayUse::Occlusion] += static_cast<uint64_t>(count);
    light_.sample.add(Pass::ambient_occlusion,
                      ambient_occlusion(scene_, settings_, vertex, branch.sampler,
                                        dimension(branch.vertex, PathDimension::Occlusion), count));
}

void DistributionTracer::send_on(const Branch& branch, const Vertex& vertex) {
    const SplitClosures lobes(vertex.closures, vertex.outgoing, vertex.point.facet_normal);
    sample_lights(branch, vertex, lobes);
    follow_singular(branch, vertex, lobes);
    scatter_glossy(branch, vertex, lobes);
    scatter_over_hemisphere(branch, vertex, lobes);
}

void DistributionTracer::add_light(const Branch& branch, const Vertex& vertex, const LightSample& light,
                                   const Color& value, const ByKind& shares, int count) {
    const float each = 1.0f / static_cast<float>(count);
    const Color arriving = branch.throughput * value * (light.radiance / light.density) * each;
    if (is_black(arriving)) return;
    ++counts_[RayUse::Shadow];
    const Color free = shadow_transmittance(scene_, vertex.point, light,
                                            shadow_differential(vertex.differential, light, count), branch.bounces);
    if (is_black(free)) return;
    if (branch.bounces.count() == 0)
        light_.add_first(arriving * free, shares, branch.share * each);
    else
        light_.add_scattered(arriving * free, branch.bounces.count() + 1, branch.first_shares, branch.share * each);
}

LitClasses DistributionTracer::lit_by_classes(const Branch& branch, const Vertex& vertex, const SplitClosures& lobes,
                                              const LightSample& light, int count) const {
    const bool kinds = (branch.bounces.count() == 0 && settings_.light_passes) || light.visibility != kVisibleAll;
    const auto lit = [&](const Closures& closures) {
        if (closures.size() == 0) return LitLobes{};
        return kinds ? lit_by_kind(vertex, closures, light) : lit_together(vertex, closures, light);
    };
    // Hemisphere rays leave sampled light to light sampling; with ambient occlusion, it leaves the world to them.
    const bool occluded_world = light.world && distribution_.indirect == IndirectLight::AmbientOcclusion;
    const LitLobes diffuse = occluded_world ? LitLobes{} : lit(lobes.diffuse());
    LitLobes glossy = lit(lobes.glossy());
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
    for (int i = 0; i < count; ++i) {
        const Sampler sampler = branch.sampler.branch(static_cast<uint32_t>(i), static_cast<uint32_t>(count), use);
        const std::optional<LightSample> light = scene_.lights().sample(vertex.point.position, sampler.get3(use));
        if (!light) continue;
        const LitClasses lit = lit_by_classes(branch, vertex, lobes, *light, count);
        add_light(branch, vertex, *light, lit.value, lit.shares, count);
    }
}

void DistributionTracer::follow_singular(const Branch& branch, const Vertex& vertex, const SplitClosures& lobes) {
    uint32_t number = 0;
    for (const LobeSample& sample : lobes.singular()) {
        Branch child = branch.scattered(vertex, vertex.closures, sample, 1);
        child.sampler = branch.sampler.branch(0, 1, dimension(branch.vertex, PathDimension::Child) ^ (number++ << 24));
        child.differential = glossy_differential(vertex.differential, -vertex.outgoing, vertex.point, sample, 1);
        child.use = RayUse::Specular;
        push(std::move(child));
    }
}

void DistributionTracer::scatter_glossy(const Branch& branch, const Vertex& vertex, const SplitClosures& lobes) {
    if (lobes.glossy().size() == 0) return;
    const int count = rays(branch, distribution_.glossy_rays);
    const uint32_t use = dimension(branch.vertex, PathDimension::Scatter);
    for (int i = 0; i < count; ++i) {
        const Sampler sampler = branch.sampler.branch(static_cast<uint32_t>(i), static_cast<uint32_t>(count), use);
        const std::optional<LobeSample> sample =
            lobes.glossy().sample(vertex.outgoing, vertex.point.facet_normal, sampler.get3(use));
        if (!sample) continue;
        Branch child = branch.scattered(vertex, lobes.glossy(), *sample, count);
        child.sampler = sampler;
        child.differential = glossy_differential(vertex.differential, -vertex.outgoing, vertex.point, *sample, count);
        child.departure.sampling = LightSampling::Weighed;
        child.departure.density = static_cast<float>(count) * sample->density;
        child.departure.light_rays = static_cast<float>(rays(branch, distribution_.light_rays));
        child.use = RayUse::Glossy;
        push(std::move(child));
    }
}

bool DistributionTracer::hemisphere_brings_light() const {
    const bool sees_world =
        scene_.has_world() && (distribution_.indirect == IndirectLight::AmbientOcclusion ||
                               !(scene_.lights().world_density(Vec3f(0.0f, 0.0f, 1.0f), Vec3d(0.0)) > 0.0f));
    return sees_world || (distribution_.indirect == IndirectLight::ColorBleeding && settings_.diffuse_bounces > 0);
}

void DistributionTracer::scatter_over_hemisphere(const Branch& branch, const Vertex& vertex,
                                                 const SplitClosures& lobes) {
    if (lobes.diffuse().size() == 0 || !hemisphere_brings_light()) return;
    const int count = rays(branch, distribution_.hemisphere_rays);
    const uint32_t use = dimension(branch.vertex, PathDimension::Hemisphere);
    for (int i = 0; i < count; ++i) {
        const Sampler sampler = branch.sampler.branch(static_cast<uint32_t>(i), static_cast<uint32_t>(count), use);
        const std::optional<LobeSample> sample =
            lobes.diffuse().sample(vertex.outgoing, vertex.point.facet_normal, sampler.get3(use));
        if (!sample) continue;
        Branch child = branch.scattered(vertex, lobes.diffuse(), *sample, count);
        child.sampler = sampler;
        child.differential =
            hemisphere_differential(vertex.differential, sample->direction, kPi * sample->density, count);
        child.departure.sampling = LightSampling::Alone;
        child.spread = Spread::One;
        child.use = RayUse::Hemisphere;
        if (distribution_.indirect == IndirectLight::AmbientOcclusion)
            add_unoccluded_world(child);
        else
            push(std::move(child));
    }
}

void DistributionTracer::add_unoccluded_world(const Branch& child) {
    ++counts_[child.use];
    Ray ray = child.ray;
    ray.t_max = settings_.occlusion_distance;
    const PathState state = child.bounces.at(0);
    const Color free =
        free_share(scene_, ray, child.differential, child.bounces.ray_kind(), state, child.bounces.transparent_left());
    if (is_black(free)) return;
    add(child, free * scene_.world(Vec3f(ray.direction), child.differential, state), Pass::environment);
}

void DistributionTracer::sample_light_once(const Branch& branch, const Vertex& vertex) {
    if (!vertex.closures.has_smooth_lobes() || scene_.lights().empty()) return;
    const std::optional<LightSample> light = scene_.lights().sample(
        vertex.point.position, branch.sampler.get3(dimension(branch.vertex, PathDimension::Light)));
    if (!light) return;
    const LitLobes lit = light->visibility != kVisibleAll ? lit_by_kind(vertex, vertex.closures, *light)
                                                          : lit_together(vertex, vertex.closures, *light);
    const float weight = light->delta ? 1.0f : power_heuristic(light->density, lit.density);
    add_light(branch, vertex, *light, lit.value * weight, {}, 1);
}

void DistributionTracer::send_one_on(const Branch& branch, const Vertex& vertex) {
    const bool last = branch.bounces.is_last();
    if (!last) sample_light_once(branch, vertex);
    const float through = max_component(vertex.closures.transparency);
    float scattering = 0.0f;
    for (int i = 0; i < vertex.closures.size() && !last; ++i) scattering += max_component(vertex.closures[i].weight);
    const float straight = through > 0.0f ? through / (through + scattering) : 0.0f;
    if (straight > 0.0f && branch.random(PathDimension::Transparency) < straight) {
        Branch child = branch.straight_on(vertex);
        child.throughput /= straight;
        return push(std::move(child));
    }
    if (last) return;
    const std::optional<LobeSample> sample =
        vertex.closures.sample(vertex.outgoing, vertex.point.facet_normal,
                               branch.sampler.get3(dimension(branch.vertex, PathDimension::Scatter)));
    if (!sample) return;
    Branch child = branch.scattered(vertex, vertex.closures, *sample, 1);
    child.throughput /= 1.0f - straight;
    child.differential = scattered_differential(vertex.differential, -vertex.outgoing, vertex.point, *sample);
    if (!sample->singular) {
        child.departure.sampling = LightSampling::Weighed;
        child.departure.density = sample->density;
    }
    child.use = RayUse::Indirect;
    push(std::move(child));
}

void DistributionTracer::push(Branch&& branch) {
    if (survives(branch, settings_)) pending_.push_back(std::move(branch));
}

}  // namespace

DistributionSettings::DistributionSettings(const Settings& settings)
    : path(settings),
      glossy_rays(settings.glossy_rays),
      light_rays(settings.light_rays),
      hemisphere_rays(settings.hemisphere_rays),
      indirect(settings.indirect) {
    path.diffuse_bounces = std::min(path.diffuse_bounces, indirect == IndirectLight::ColorBleeding ? 1 : 0);
}

PixelSample trace_distributed(const Scene& scene, const DistributionSettings& settings, const CameraRay& camera_ray,
                              const Sampler& sampler, RayCounts& counts) {
    return DistributionTracer(scene, settings, camera_ray, sampler, counts).trace();
}

}  // namespace rayleaf
