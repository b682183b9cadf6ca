// One path, in steps: what it must trace next, and what it makes of the answer.
#pragma once

#include "base/sample_pairs.h"
#include "integrators/bounces.h"
#include "integrators/contributions.h"
#include "integrators/denoising_features.h"
#include "integrators/dimensions.h"
#include "integrators/medium_tracking.h"
#include "integrators/path.h"
#include "integrators/shadow.h"
#include "integrators/vertex.h"

#include <optional>
#include <vector>

namespace rayleaf {

/// A ray to a sampled light.
struct LightRay : FreeWay {
    explicit LightRay(const Color& light) : arriving(light) {}

    uint32_t path = 0;  ///< its place in a stream
    Color arriving;     ///< light that reaches the camera if nothing blocks it
    float share = 1;    ///< of a camera sample: several rays leave one vertex
    ByKind shares;      ///< where the vertex is the first: in the kinds of its lobes
    bool first = false;
    int group = -1;       ///< the light's slot
    int scatterings = 1;  ///< on the way from the light to the camera
};

/// The random numbers of a vertex that nearly each one needs.
struct VertexNumbers {
    Vec2f light, scatter;  ///< PathDimension's
};

/// How the ray under way came about: what light sampling would have done instead.
struct Departure {
    float density = 0;  ///< with which scattering chose the direction; 0: no light sampling could have
    LitPoint from;      ///< where lights were sampled

    float weight(float light_density) const {
        return density > 0.0f && light_density > 0.0f ? power_heuristic(density, light_density) : 1.0f;
    }
};

/// What a path leaves behind where it meets a shadow catcher.
struct CaughtPath {
    Vec4f objects{0, 0, 0, 0};  ///< what it saw before, and its alpha
    Vec4f footage{0, 0, 0, 0};  ///< what lies behind, where the picture shows it
};

/// What a path does where its ray has arrived.
enum class Arrival : uint8_t {
    Ends,
    AtSurface,  ///< is to be shaded
    InWorld,    ///< asks what the world shows, and ends
    GoesOn      ///< by its next ray: a medium scattered it, or began or ended
};

class alignas(64) PathTracer {  // begins with a line of the cache
  public:
    PathTracer(const Scene& scene, const PathSettings& settings, const CameraRay& camera_ray, const Sampler& sampler,
               RayCounts& counts)
        : scene_(scene),
          settings_(settings),
          counts_(counts),
          sampler_(sampler),
          bounces_(settings),
          has_footprint_(scene.needs_footprints()),
          sees_(camera_ray.exists),
          ray_(from_camera(camera_ray.ray)),
          departure_{.from = {camera_ray.ray.origin}},
          light_(settings) {
        if (has_footprint_) differential_ = camera_ray.differential;
        if (scene.has_media()) media_ = media_around(scene, ray_.at(ray_.t_min), ray_.time);
    }

    /// Where the path writes what it is asked beside the passes of the table; before its first ray.
    void write_extras(SampleExtras& extras) {
        extras.clear(settings_.slots);
        light_.sample.extras = &extras;
    }
    /// All of the path, ray by ray.
    PixelSample trace();

    /// False: there is no ray to trace.
    bool sees() const { return sees_; }
    // The same in steps, so that the rays of many paths can be traced together:
    /// The ray to trace next. Valid until the path has arrived.
    RayQuery next_ray() {
        ++counts_[use_];
        if (scene_.needs_widths()) set_width(ray_, differential_, widening());
        return {&ray_, bounces_.ray_kind(), scene_.needs_differentials() ? &differential_ : nullptr};
    }
    /// What the ray met, and what that gives but for the surface there. `found` is changed where the ray has left glass
    /// that it cannot meet again; it must stay until the path goes on.
    /// Rays to lights that media scatter on the way are appended to `light_rays`.
    Arrival arrive(ClosestHit& found, std::vector<LightRay>& light_rays);
    /// The ray that arrived, its hit and the material there, where a surface is to be shaded.
    const Ray& ray() const { return ray_; }
    const Hit& hit() const { return *hit_; }
    const Material& material() const { return *material_; }
    /// Whether a surface that it has arrived at is the first shadow catcher; then `split` is asked for, before shading.
    bool meets_catcher() const;
    /// The same path in the footage alone, to be followed from here; what it gives is then taken.
    PathTracer split();
    void take_footage(const PixelSample& alone);
    /// The inputs of the world's program, where it is asked; `closures` are what it will fill.
    ShadingInputs look_at_world(Closures& closures) const;
    /// What it shows.
    void take_world(const Color& radiance);
    /// Completes a vertex of which the surface point is known; the inputs of the material's program.
    ShadingInputs approach(Vertex& vertex) const;
    /// Asks for the random numbers of the vertex: kPairsOfVertex of them.
    void ask_numbers(SamplePairs& pairs) const;
    static constexpr size_t kPairsOfVertex = 2;
    /// The numbers that were requested; `first` is the first pair.
    static VertexNumbers numbers(const SamplePairs& pairs, size_t first) {
        return {pairs.pair(first), pairs.pair(first + 1)};
    }
    /// Leaves out of closures what the path's settings drop; before shading.
    void simplify(Closures& closures) const { bounces_.simplify(closures); }
    /// Takes what a vertex shows whose closures are known, and appends which lights are wanted for it to `wanted`; they
    /// ask from the vertex, which must stay. False: the path ends.
    bool look(Vertex& vertex, const Vec2f& random, std::vector<LightQuery>& wanted);
    /// Whether it counts what each kind of lobe makes of a light.
    bool asks_kinds(const LightSample& light) const {
        return (bounces_.count() == 0 && settings_.light_passes) || !lights_all_kinds(light);
    }
    /// True if the path goes on from there; rays to the lights, which are known now, may be wanted either way, and are
    /// appended to `light_rays`.
    bool leave(Vertex& vertex, const Vec2f& random, std::span<LightQuery> lights, std::vector<LightRay>& light_rays);
    /// The share of the light of such a ray that arrives.
    void receive(const LightRay& from, const Color& free);
    /// Valid as long as the path.
    const PixelSample& finish();

  private:
    // What each step needs lies together: streams hold more paths than the nearest cache.
    const Scene& scene_;
    const PathSettings& settings_;
    RayCounts& counts_;
    Sampler sampler_;
    const Hit* hit_ = nullptr;  ///< of the vertex; null: the ray met nothing
    const Material* material_ = nullptr;
    Color throughput_{1, 1, 1};
    float alpha_ = 1;
    Bounces bounces_;
    int vertex_ = 0;
    uint32_t outside_of_ = kNowhere;  ///< instance of glass that the ray under way has just left
    float world_density_ = 0;      ///< with which light sampling would have chosen the direction in which the path left
    RayUse use_ = RayUse::Camera;  ///< of the ray under way
    bool has_footprint_;           ///< differentials count, and are kept
    bool sees_;                    ///< false: the camera shows nothing there
    bool surface_recorded_ = false;
    bool has_departed_ = false;  ///< was scattered, and has met nothing yet
    Ray ray_;
    RayDifferential differential_;
    Departure departure_;
    Maybe<CaughtPath> caught_;  ///< once it has met a shadow catcher
    ByKind first_shares_;       ///< of the first scattering
    DenoisingFeatures features_;
    MediumStack media_;  ///< that the ray under way starts in
    Contributions light_;
    static constexpr uint32_t kNowhere = RayAnchor::kNone;

    /// A copy of what cameras set. A copy of the whole ray would wait for their writes.
    static Ray from_camera(const Ray& ray) {
        Ray result;
        result.origin = ray.origin;
        result.direction = ray.direction;
        result.t_min = ray.t_min;
        result.t_max = ray.t_max;
        result.time = ray.time;
        return result;
    }
    float importance() const { return max_abs(throughput_); }
    RayWidening widening() const { return settings_.widening(importance(), bounces_.count() > 0); }
    void take_hit(ClosestHit& found);
    Arrival arrive_alone(ClosestHit& found);
    void receive_alone(std::vector<LightRay>& light_rays);
    /// From where it has arrived by the answer `found`.
    void follow(Arrival arrival, ClosestHit& found);
    bool shade_alone(std::vector<LightRay>& light_rays);
    bool see_world_alone();
    void pass_volumes();
    /// True if a medium scattered the path's light before the ray's end.
    bool pass_media(double end, std::vector<LightRay>& light_rays);
    void add_scattered_light(const MediumSegment& segment, const SegmentBounds& bounds,
                             std::vector<LightRay>& light_rays);
    void scatter_in_medium(const MediumPassage& passage, const PhaseSample& sample);
    void pass_boundary();
    Vec2f random2(PathDimension use) const { return sampler_.get2(dimension(vertex_, use)); }
    float random(PathDimension use) const { return sampler_.get1(dimension(vertex_, use)); }

    /// Whether a surface that scatters no more can still matter.
    bool may_shine_or_let_through() const {
        return material_->surface->emits() || material_->surface->may_be_transparent();
    }
    /// With which footprint to look up textures. Light sampling looks at points: where it might have found the same
    /// emission, both must see it alike, or their weights would not add up to one.
    RayDifferential footprint_on_surface(const RayDifferential& differential) const {
        const bool sampled = material_->surface->emits() && departure_.density > 0.0f;
        return sampled ? RayDifferential{} : differential;
    }
    /// Records light that the ray under way met, before the path's throughput; `seen` is its pass where the camera sees
    /// it.
    void add(const Color& radiance, Pass seen, int group);
    void add_lamps(double t_max);
    /// Of lights with blockers of their own (integrators/blocked_light.h).
    void add_blocked_lights();
    /// Before the ray's end.
    Color free_of_media(double t) const;
    bool hides_world() const { return bounces_.sees_film(); }
    /// Whether the world's program must be asked what the world shows.
    bool leave_scene();
    void add_emission(const Vertex& vertex);
    void want_lights(Vertex& vertex, const Vec2f& random, std::vector<LightQuery>& wanted) const;
    void add_lights(const Vertex& vertex, std::span<LightQuery> lights, std::vector<LightRay>& light_rays);
    /// One of several sampled lights.
    struct Sibling {
        int index, count;
    };
    void add_sampled_light(const Vertex& vertex, const LightSample& light, const Sibling& sibling,
                           std::vector<LightRay>& light_rays);
    void record_surface(const Vertex& vertex);
    /// Where programs write their AOVs at the vertex; empty where none are wanted.
    std::span<Vec4f> aovs() const {
        const bool seen = settings_.slots > 0 && bounces_.count() == 0 && !surface_recorded_ && light_.sample.extras;
        return seen ? std::span<Vec4f>(light_.sample.extras->slots) : std::span<Vec4f>();
    }

    /// True if the path goes on past the surface.
    bool go_on(const Vertex& vertex, const Vec2f& random, std::vector<LightRay>& light_rays);
    bool pass_through(const Vertex& vertex, float probability);
    bool pass_portal(const Vertex& vertex, float probability);
    bool scatter(const Vertex& vertex, const Vec2f& random, std::vector<LightRay>& light_rays);
    /// Light that enters the body at the vertex: lit and scattered on where it leaves.
    bool scatter_below(const Vertex& vertex, const LobeSample& entry, std::vector<LightRay>& light_rays);
    bool survives_roulette();
    float straight_probability(const Vertex& vertex) const;
    void catch_light();
    void divide_by_catchers();
};

}  // namespace rayleaf
