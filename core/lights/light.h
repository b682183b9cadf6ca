// Lamps and emitting surfaces: their emission, samples and densities, and the choice of one.
//
// Strengths are Blender's, as Cycles 3.4 takes them (measured in tests/blender/test_lamp_oracle.py): a point lamp of P
// watts has the radiant intensity P / (4 pi) W/sr; a spot that times the cosine to its axis; a sun the irradiance
// given; an area lamp of P watts and area A the radiance P / (4 A). A lamp too small for its radiance to be a float is
// a delta light. Black lamps are left out.
#pragma once

#include "base/cancel.h"
#include "base/maybe.h"
#include "base/vector.h"
#include "lights/light_linking.h"
#include "rays/ray.h"
#include "shading/inputs.h"
#include "trace/tracer.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rayleaf {

enum class LampKind : uint8_t { Point, Sun, Spot, Rectangle, Disk };
inline constexpr int kLampKinds = static_cast<int>(LampKind::Disk) + 1;

/// A spot's intensity within its cone, before it fades: by the cosine to the axis (Blender 3) or even (Blender 4).
enum class SpotProfile : uint8_t { Cosine, Even };

class Program;  // shading/program.h

/// A lamp as Blender describes it. It shines along the -z axis of its frame.
struct Lamp {
    std::string name;
    LampKind kind = LampKind::Point;
    Affine3d to_world;        ///< scale counts for area lamps only
    Color strength{0, 0, 0};  ///< colour times watts; the sun: colour times W/m²; negative takes light away
    double radius = 0;        ///< point and spot: of the shining sphere, world units; 0 is a point
    double angle = 0;         ///< sun: angular diameter, radians
    double spot_size = 0;     ///< full cone angle, radians
    double spot_blend = 0;    ///< 0..1 share of the cone that fades
    SpotProfile spot_profile = SpotProfile::Cosine;
    bool soft_falloff = false;         ///< point and spot: a disk that faces whoever looks takes the sphere's place
    double size_x = 1, size_y = 1;     ///< area lamps, in lamp space; a disk's axes
    double spread = 3.14159265358979;  ///< area lamps: full angle of emission, radians
    bool casts_shadow = true;
    uint8_t visibility =
        kVisibleAll | kOfFootage;  ///< which rays may hit the lamp itself; whether it is in the footage
    int light_group = -1;          ///< the slot of its light (film/pass.h); -1: none
    /// What it emits is a factor on the strength, by place and direction; null: 1.
    std::shared_ptr<const Program> emission = nullptr;
    LightLink link;
};

/// A point of a lamp with a program, seen from somewhere.
struct LampPoint {
    size_t lamp = 0;          ///< place in the list of lamps
    Vec3d position{0, 0, 0};  ///< world; the sun: the direction to it
    Vec3f outgoing{0, 0, 1};  ///< unit, towards who sees it
    PathState path;           ///< of who sees it; its length is that from there, infinity for suns
};

/// A point of an emitting surface, seen from somewhere.
struct EmitterPoint {
    const SurfacePoint* point = nullptr;
    Vec3f outgoing{0, 0, 1};  ///< unit, towards who sees it
    PathState path;           ///< of who sees it; its length is that from there
};

/// A direction in which the world is seen.
struct WorldDirection {
    Vec3f direction{0, 0, 1};  ///< unit
    PathState path;            ///< of who sees it
};

/// Light that arrives at a point from a sampled direction.
struct LightSample {
    Vec3f direction{0, 0, 1};  ///< unit, from the point to the light
    double distance = 0;       ///< world units; infinity for suns and the world
    Vec3d target{0, 0, 0};     ///< where the way must be free up to, if the distance is finite; world
    RayAnchor target_anchor;   ///< of an emitting surface: what the ray to `target` ends on
    Color radiance{0, 0, 0};   ///< arriving if nothing is in the way; delta lights: irradiance at normal incidence
    float density = 0;         ///< per solid angle, choice of the light included; delta lights: the choice alone
    bool delta = false;        ///< cannot be hit by a scattered ray
    bool casts_shadow = true;
    bool world = false;                 ///< light of the world, not of a lamp or surface
    int lamp_group = -1;                ///< light group of the lamp; -1: none, or no lamp
    int instance = -1;                  ///< of an emitting surface; else -1
    uint16_t visibility = kVisibleAll;  ///< which kinds of rays see the light: other lobes are not lit by it
    int8_t blockers = -1;               ///< whose shadows it has (LightLink)
};

/// A light with a place, as a ray sees it that passes by.
struct PassedLight {
    Vec3d center{0, 0, 0};
    double radius = 0;          ///< world units, about
    double intensity = 0;       ///< W/sr at best
    double begin = 0, end = 0;  ///< the part of the ray on which it may shine
};

/// All of them, as long as they are few; of many, one.
struct PassedLights {
    static constexpr size_t kMost = 8;

    std::array<PassedLight, kMost> lights;
    size_t count = 0;
    double far_share = 0;  ///< of the light that comes from suns and the world, roughly

    std::span<const PassedLight> all() const { return {lights.data(), count}; }
};

/// Makes it the light as paths see it that meet nothing but what stands in the footage.
inline void see_in_footage(LightSample& light) {
    light.visibility = static_cast<uint16_t>(light.visibility >> kFootageShift);
}

/// What a ray that misses or passes lamps meets: a lamp, with the density light sampling would have had for it.
struct LampHit {
    double t = 0;
    Color radiance{0, 0, 0};
    float density = 0;
    int light_group = -1;  ///< the lamp's
    int blockers = -1;     ///< the lamp's
};

/// The state with which the program of a sampled light is evaluated: of no kind of ray, as in Cycles, and at depth 1,
/// one bounce beyond what the camera sees.
inline PathState sampling_state() {
    PathState state;
    state.camera = false;
    state.depth = 1;
    return state;
}

/// A light that is wanted for a point, and the answer.
struct LightQuery {
    LitPoint* at = nullptr;  ///< gets its groups, if they are not known
    /// In [0,1)². x chooses the light, and what the choice leaves of it is used again with y for the place on it: so
    /// the places on each light are stratified as the pair is, 2^-24 over the light's probability apart.
    Vec2f random{0, 0};
    float time = kMiddleTime;  ///< of the shutter
    PathState path;            ///< for programs of lights; its ray length is filled in
    Maybe<LightSample> light;  ///< empty: none arrives
};

/// Queries that are answered together, at most: as many as programs are run for at once (kMostPoints).
inline constexpr size_t kMostTogether = 32;

/// What surfaces, the world and lamps emit where they are seen: a radiance for each of the points, given by the scene.
/// Points that are asked together cost less.
using SurfaceEmission = std::function<void(std::span<const EmitterPoint>, Color* radiances)>;
using WorldEmission = std::function<void(std::span<const WorldDirection>, Color* radiances)>;
/// Of lamps with programs, factors on their strengths.
using LampEmission = std::function<void(std::span<const LampPoint>, Color* factors)>;
/// What a surface emits that emits alike everywhere and in all directions; null: it may not.
using EvenEmission = std::function<const Color*(uint32_t instance, const LocalHit&)>;

/// Whether a surface that does not shine casts a shadow that lets no light through.
using Blocking = std::function<bool(uint32_t instance, const LocalHit&)>;

struct Emissions {
    SurfaceEmission surface;
    EvenEmission even;
    Blocking blocks;
    WorldEmission world;
    LampEmission lamp;
    uint8_t world_visibility = kVisibleAll;  ///< which rays see the world
};

/// An emitting instance, all elements of which whose material slot emits.
struct EmittingInstance {
    uint32_t instance = 0;
    std::vector<uint32_t> elements;
    LightLink link = {};
};

class WorldLight;  // lights/world_light.h

class LightSet {
  public:
    /// `world_light` is the table by which the world is importance sampled; null: not sampled. Black and constant
    /// worlds are sampled by scattering alone whatever it is. Throws Cancelled soon after `cancel` says so.
    LightSet(const std::vector<Lamp>& lamps, const std::vector<EmittingInstance>& emitters, const Tracer& tracer,
             Emissions emissions, std::shared_ptr<const WorldLight> world_light, const CancelToken& cancel);
    ~LightSet();
    LightSet(const LightSet&) = delete;
    LightSet& operator=(const LightSet&) = delete;

    bool empty() const { return empty_; }                  ///< nothing to sample
    bool holds_several() const { return holds_several_; }  ///< lamps, suns, emitting instances, a world that is sampled
    /// False: no light that is sampled asks for the path's state.
    bool asks_path() const { return asks_path_; }
    /// Chooses a light for each query: the same bits as one by one, in less time where lights have programs.
    void sample(std::span<LightQuery> queries) const;
    /// A light for one point (LightQuery).
    Maybe<LightSample> sample(const LitPoint& at, const Vec2f& random, float time = kMiddleTime,
                              const PathState& path = sampling_state()) const;
    /// The lights that the first `end` of a ray passes. `likely`: a point of it by which one is chosen, by `random` in
    /// [0,1), where there are many, and by which those that have no place are weighed.
    PassedLights passed(const Ray& ray, double end, const LitPoint& likely, float random) const;
    /// Whether it matters what is likely.
    bool weighs_passed() const;
    /// All lights with a place that shine on what is lit by `lit_by`, but for parts of rays; none where there are many.
    PassedLights placed(LightSets lit_by) const;
    /// Density with which `sample` at `from` would have chosen the direction to an emitting surface point; 0 where that
    /// does not shine on `from`.
    float emitter_density(const LitPoint& from, const SurfacePoint& point) const;
    /// The same for the world in `direction`.
    float world_density(const Vec3f& direction, const LitPoint& from) const;
    /// Calls `add` for each lamp with a size that the ray meets in (t_min, end), in no order: they add up. Suns are met
    /// where `end` is infinite only. `from` is where `sample` stood for the densities, usually near the origin;
    /// lamps that do not shine on it are left out. `path`: as for `sample`; its length counts from there.
    void lamp_hits(const Ray& ray, double end, const LitPoint& from, Visibility kind, const PathState& path,
                   const std::function<void(const LampHit&)>& add) const;
    /// False: lamp_hits finds none.
    bool may_meet_lamps(const Ray& ray, double end) const;
    /// Of what shines where a ray of a kind ends, the largest component of its radiance; empty, and no ray is traced,
    /// where nothing brighter than `least` may be met. A guess to sample by: surfaces are opaque, and programs of lamps
    /// have their mean.
    std::optional<float> brightness_along(const Ray& ray, Visibility kind, const PathState& path, float least) const;
    /// Whether any light shines on some objects alone, or has the shadows of some alone.
    bool has_links() const;
    /// Emitting instances that have the shadows of some objects alone; and whether such lamps can be met.
    const std::vector<uint32_t>& emitters_with_blockers() const;
    bool has_hittable_lamps_with_blockers() const;
    size_t bytes() const;
    size_t count() const;

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
    bool empty_, holds_several_, asks_path_;
};

}  // namespace rayleaf
