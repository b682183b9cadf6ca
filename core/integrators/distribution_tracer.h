// The tree of rays that one camera ray grows (integrators/distribution.h); shared by the files that grow it.
#pragma once

#include "integrators/branch.h"
#include "integrators/distribution.h"
#include "integrators/medium_tracking.h"
#include "integrators/shadow.h"
#include "shading/split_closures.h"

#include <vector>

namespace rayleaf {

/// What both classes of rough lobes make of a sampled light.
struct LitClasses {
    Color value{0, 0, 0};
    ByKind shares;
};

/// Light on its way from a sampled light, to be told how much of it arrives.
struct SentLight {
    Color value{0, 0, 0};
    ByKind shares;        ///< of the first scattering
    int group = -1;       ///< of lights
    int scatterings = 1;  ///< on the way to the camera
    float share = 1;      ///< of the camera sample
    bool waits = false;   ///< for its way; else all of it arrives
};

/// A ray that brings the world's light, to be told how much gets through.
struct WorldRay {
    Color throughput{0, 0, 0};  ///< as of Branch
    float share = 1;            ///< so too
    ByKind first_shares;        ///< so too
    int scatterings = 1;        ///< on the way to the camera
    Vec3f direction{0, 0, 1};
    RayDifferential differential;
    PathState state;
    Visibility kind = kVisibleDiffuse;
};

/// A direction over a hemisphere, one of `count`.
struct HemisphereSample {
    const LobeSample& sample;
    Sampler sampler;  ///< of the ray's random numbers
    int count;
};

class DistributionTracer {
  public:
    /// `counts` gets the rays.
    DistributionTracer(const DistributionFrame& frame, RayCounts& counts)
        : frame_(frame),
          scene_(frame.scene),
          distribution_(frame.settings),
          settings_(frame.settings.path),
          counts_(&counts),
          has_footprint_(frame.scene.needs_footprints()),
          light_(frame.settings.path) {}

    /// Gets the rays from now on.
    void count_in(RayCounts& counts) { counts_ = &counts; }
    /// Begins with a camera ray, and forgets the one before.
    void begin(const CameraRay& camera_ray, const Sampler& sampler);
    /// What the settings ask for beside passes goes there.
    void write_extras(SampleExtras& extras);
    /// What one camera ray and all that follow contribute: ray by ray.
    const PixelSample& trace_alone();
    HemisphereRay trace_hemisphere(const Branch& ray);

    // The same in steps, for many camera rays together. While `goes_on`: `next_ray`, `arrive`; if it says so, the
    // surface is shaded: `approach`, `shade`; then what waits for its way is told how much gets through.
    bool goes_on() const { return !pending_.empty(); }
    RayQuery next_ray();
    /// True if the ray met a surface that must be shaded.
    bool arrive(ClosestHit found);
    const Ray& ray() const { return branch_->ray; }
    const Hit& hit() const { return *hit_; }
    /// The vertex has its point.
    ShadingInputs approach(Vertex& vertex);
    /// The vertex has its closures.
    void shade(Vertex& vertex);
    std::span<FreeWay> light_ways() { return light_ways_; }
    void receive_light(const Color* free);
    std::span<FreeWay> world_ways() { return world_ways_; }
    void receive_world(const Color* free);
    const PixelSample& finish();

  private:
    const DistributionFrame& frame_;
    const Scene& scene_;
    const DistributionSettings& distribution_;
    const PathSettings& settings_;
    RayCounts* counts_;
    bool has_footprint_;  ///< differentials count, and are kept
    Contributions light_;
    std::vector<Branch> pending_;   ///< last in, first out
    std::optional<Branch> branch_;  ///< under way
    Maybe<Hit> hit_;                ///< of `branch_`
    std::vector<SentLight> sent_;
    std::vector<FreeWay> light_ways_;  ///< of what waits of `sent_`, in its order
    std::vector<WorldRay> world_rays_;
    std::vector<FreeWay> world_ways_;  ///< theirs
    float alpha_ = 1;
    bool surface_recorded_ = false;

    RayWidening widening(const Branch& branch) const {
        return settings_.widening(branch.importance(), branch.bounces.count() > 0);
    }
    /// The branch's ray as wide as it is to be.
    Ray ray_of(const Branch& branch) const {
        Ray ray = branch.ray;
        if (scene_.needs_widths()) set_width(ray, branch.differential, widening(branch));
        return ray;
    }
    /// Along it, or a part of it.
    FreeWay way_of(const Branch& branch, const Ray& ray) const {
        return {ray,
                branch.differential,
                branch.bounces.ray_kind(),
                branch.bounces.at(0),
                branch.bounces.transparent_left(),
                widening(branch),
                branch.media,
                RandomStream(branch.sampler, dimension(branch.vertex, PathDimension::ShadowWalk))};
    }
    void follow_pending();
    /// What the ray under way makes of its end, ray by ray.
    void arrive_alone(const ClosestHit& found);
    const RayDifferential* differential_of(const Branch& branch) const {
        return scene_.needs_differentials() ? &branch.differential : nullptr;
    }
    /// Begun anew behind glass that the ray has just left (integrators/glass_path.h).
    void leave_glass(Branch& branch, ClosestHit& found) const;
    void pass_volumes(Branch& branch, const Maybe<Hit>& hit);
    /// True if a medium scattered the ray's light on the way: then the branch ends.
    bool pass_media(Branch& branch, double end);
    Color free_of_media(const Branch& branch, double t) const;
    void pass_boundary(const Branch& branch, const Hit& hit);
    void add_scattered_light(const Branch& branch, const MediumSegment& segment, const SegmentBounds& bounds);
    /// Records light that a ray met, before its throughput; `seen` is its pass where the camera sees it.
    void add(const Branch& branch, const Color& radiance, Pass seen, int group);
    /// Where programs write their AOVs at the end of the ray; empty where none are wanted.
    std::span<Vec4f> aovs(const Branch& branch) const {
        const bool seen = light_.sample.extras && branch.bounces.count() == 0 && !surface_recorded_;
        return seen ? std::span<Vec4f>(light_.sample.extras->slots) : std::span<Vec4f>();
    }
    void add_lamps(const Branch& branch, double t_max);
    /// Of lights with blockers of their own (integrators/blocked_light.h).
    void add_blocked_lights(const Branch& branch);
    void add_world(const Branch& branch);
    void add_emission(const Branch& branch, const Vertex& vertex);
    void record_surface(const Branch& branch, const Vertex& vertex);

    /// Number of rays of a kind of which `wanted` are set.
    int rays(const Branch& branch, int wanted) const {
        return branch.spread == Spread::One
                   ? 1
                   : std::max(1, static_cast<int>(std::lround(static_cast<float>(wanted) * branch.share)));
    }
    void send_on(const Branch& branch, const Hit& hit, const Vertex& vertex);
    /// One of `siblings` rays to a light waits for its way; false where nothing can be in it.
    bool send_on_way(const Branch& branch, const Vertex& vertex, const LightSample& light, int siblings);
    void send_light(const Branch& branch, const Vertex& vertex, const LightSample& light, const Color& value,
                    const ByKind& shares, int count);
    /// Light that was sent, ray by ray or in packets of its own.
    void receive_light_alone();
    LitClasses lit_by_classes(const Branch& branch, const Vertex& vertex, const SplitClosures& lobes,
                              const LightSample& light, int count) const;
    void sample_lights(const Branch& branch, const Vertex& vertex, const SplitClosures& lobes);
    /// `hit` is the vertex's.
    void follow_singular(const Branch& branch, const Hit& hit, const Vertex& vertex, const SplitClosures& lobes);
    void scatter_glossy(const Branch& branch, const Vertex& vertex, const SplitClosures& lobes);
    void scatter_over_hemisphere(const Branch& branch, const Vertex& vertex, const SplitClosures& lobes);
    void scatter_below(const Branch& branch, const Vertex& vertex, const SplitClosures& lobes);
    /// One walk of light that enters by `entry`; `branch` carries its share.
    void walk_on(Branch branch, const Vertex& vertex, const LobeSample& entry);
    /// The ray brings the world's light, as far as nothing occludes it.
    void ask_world(const Branch& branch, const Vertex& vertex, const Closures& lobes, const HemisphereSample& chosen);
    void send_over_hemisphere(const Branch& branch, const Vertex& vertex, const Closures& lobes,
                              const HemisphereSample& chosen);
    void receive_world_alone();
    /// True where the cache answered for all lobes.
    bool add_cached_hemisphere(const Branch& branch, const Vertex& vertex, const Closures& lobes);
    void add_occlusion(const Branch& branch, const Vertex& vertex);

    void sample_light_once(const Branch& branch, const Vertex& vertex);
    void send_one_on(const Branch& branch, const Hit& hit, const Vertex& vertex);
    /// By the lobes alone; `straight` is the probability with which the ray would have gone straight on.
    void scatter_once(const Branch& branch, const Hit& hit, const Vertex& vertex, float straight);
    /// Takes up a ray that `sample` made of one that met `hit`: from where it leaves the glass, if it enters some.
    void push_scattered(Branch&& branch, const Hit& hit, const Vertex& from, const LobeSample& sample);

    /// Takes a ray up, unless it is black or, being dim, ends by chance.
    void push(Branch&& branch);
    /// The same for one that leaves a vertex, maybe into other media.
    void push(Branch&& branch, const Vertex& from) {
        enter_media(branch, from);
        push(std::move(branch));
    }
    void enter_media(Branch& branch, const Vertex& from) const {
        if (scene_.has_media())
            leave_towards(scene_, from.point, from.outgoing, Vec3f(branch.ray.direction), branch.media);
    }
};

}  // namespace rayleaf
