// The closures of one point: a short list of weighted lobes that can be evaluated, sampled and weighed.
//
// Directions are unit, world space, and point away from the surface. `outgoing` is towards the viewer.
//
// Values are for radiance, as Cycles has it: refraction does not scale radiance by the squared ratio of indices. (What
// enters glass leaves it again, and then the factors cancel; only pictures taken from inside would differ.)
#pragma once

#include "base/vector.h"
#include "shading/medium.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>

namespace rayleaf {

/// Which of Blender's pass families and bounce limits a lobe belongs to.
enum class LobeKind : uint8_t { Diffuse, Glossy, Transmission };
inline constexpr size_t kLobeKindCount = 3;

enum class LobeType : uint8_t {
    Diffuse,            ///< Lambert, or Oren-Nayar with roughness
    Translucent,        ///< Lambert on the far side
    Reflection,         ///< GGX or Beckmann microfacets, reflection; roughness 0 is a mirror
    Refraction,         ///< the same, refraction
    Glass,              ///< both, weighted by Fresnel: a facet is chosen first, and then its way
    Sheet,              ///< what a thin sheet lets through: Reflection, its directions mirrored by the surface
    Sheen,              ///< Disney's
    Microfibres,        ///< sheen of a layer of fibres (shading/microfibres.h)
    Velvet,             ///< Ashikhmin's velvet
    ToonDiffuse,        ///< the same all over a cone around the normal
    ToonGlossy,         ///< around the mirror direction
    PrincipledDiffuse,  ///< Disney diffuse with its retro-reflection
    RetroReflection,    ///< the second of these alone
    LambertExit,        ///< Lambert, darkened at grazing as Disney's is: of light that leaves a body
    Clearcoat,
    HairReflection,    ///< Hair BSDF (shading/lobe_fibre.h)
    HairTransmission,  ///< the same
    HairFibre,         ///< Principled Hair BSDF, Chiang's model
    HairFacets,        ///< the same, Huang's model (shading/lobe_hair_facets.h)
    Subsurface         ///< light that enters, and leaves elsewhere (shading/subsurface.h): never evaluated
};

enum class MicrofacetDistribution : uint8_t { Ggx, Beckmann };
/// Smith's masking: whether facets are hidden from the light independently of the viewer, or jointly, as the same low
/// facets are hidden from both.
enum class Masking : uint8_t { Separate, Joint };

/// By what the colours of interference are seen: the CIE's standard observer, or sums of Gaussian curves that are like
/// it.
enum class FilmObserver : uint8_t { Standard, Gaussians };
/// A transparent film on a surface, in which light interferes (shading/thin_film.h).
struct ThinFilm {
    float thickness = 0;  ///< nanometres; 0: none
    float ior = 1.33f;    ///< its index over that on the viewer's side
    FilmObserver observer = FilmObserver::Standard;
    bool operator==(const ThinFilm&) const = default;
};

/// How light enters a body that it scatters in: all ways alike, refracted by rough facets, or by chance the one or the
/// other.
enum class EntryKind : uint8_t { Diffuse, Refracted, Either };

/// One lobe. `normal`, `tangent`, `weight` count for all types, the rest where named.
struct Lobe {
    LobeType type = LobeType::Diffuse;
    LobeKind kind = LobeKind::Diffuse;  ///< Glass: its reflection counts as Glossy, its refraction as Transmission
    MicrofacetDistribution distribution = MicrofacetDistribution::Ggx;
    Masking masking = Masking::Separate;
    bool stays_sharp = false;  ///< Reflection, Refraction, Glass: `widen` passes it by
    /// Microfacets whose `fresnel` is Dielectric, and Glass: its factors are those of the normal, whatever the facet.
    bool fresnel_at_normal = false;
    bool in_front = false;    ///< ToonGlossy: nothing at right angles to the mirror direction and beyond
    bool by_profile = false;  ///< Subsurface: light leaves by a profile of the distance, whose width `radius` is
    bool is_reduced = true;   ///< Subsurface: `radius` is as of a phase function that prefers no direction
    EntryKind entry = EntryKind::Diffuse;
    Color weight{0, 0, 0};  ///< factor on the lobe's value
    /// Glass: a further factor on what it refracts; HairFacets: on what it reflects, lets through, and reflects inside.
    Color refracted{1, 1, 1};
    Vec3f normal{0, 0, 1};  ///< unit; faces the viewer
    /// For anisotropy, made orthogonal to `normal` by `add`; without, `add` chooses one. Of hair: along the fibre.
    /// Microfibres: towards the viewer.
    Vec3f tangent{0, 0, 0};
    /// Microfacet roughness (already squared), of Subsurface where light enters; both 0: singular. Of hair: how wide it
    /// scatters along and around the fibre; HairFibre: a variance and a scale; HairFacets: the first, of facets; the
    /// second says of how many offsets a value is the mean, at most. Microfibres: their narrowing and skew.
    float alpha_x = 0, alpha_y = 0;
    float ior = 1.5f;  ///< index beyond the surface over that on the viewer's side
    /// Diffuse: Oren-Nayar's sigma, 0..1; PrincipledDiffuse: Disney's roughness; Velvet: its sigma; Toon: the cone's
    /// angle, 1 a quarter turn; HairFibre: the variance of its primary reflection; HairFacets: the shorter axis of its
    /// cross section over the longer.
    float roughness = 0;
    /// Toon: of the cone's border, 1 a quarter turn; Subsurface: anisotropy of the phase function; HairFacets: half a
    /// pixel's width in long half axes.
    float softness = 0;
    /// Diffuse: of a rough surface that keeps its energy, the albedo, else 0; Schlick, Metal: reflectance at normal
    /// incidence; Conductor: index of refraction; Subsurface: the surface's albedo; HairFibre, HairFacets: absorption
    /// over a radius.
    Color fresnel_0{0, 0, 0};
    /// Subsurface: mean free paths, world units; Metal: its dip (shading/fresnel.h); Conductor: its extinction;
    /// HairFacets: the direction of the longer axis, zero where the cross section is round.
    Color radius{0, 0, 0};
    /// HairFibre, HairFacets: sine of the angle around the fibre from the viewer to the point; of a cross section that
    /// is not round, its offset from the middle in long half axes.
    float across = 0;
    float tilt = 0;  ///< of hair: of the cuticle's scales, radians
    /// Dielectric: Reflection is weighted by the reflectance of `ior`, Refraction by the rest; None means the same for
    /// Glass. Schlick: Reflection is coloured, from `fresnel_0` to white along the dielectric curve of `ior`
    /// (shading/fresnel.h), Refraction by the rest. Subsurface with Schlick: darkened at grazing where light enters and
    /// leaves, as Disney's diffuse. Metal, Conductor: by `fresnel_0`, and `radius`.
    enum class Fresnel : uint8_t { None, Dielectric, Schlick, Metal, Conductor } fresnel = Fresnel::None;
    /// Of Reflection, Refraction and Glass with any of these.
    ThinFilm film;
};

struct ClosureView;

/// A sampled direction.
struct LobeSample {
    Vec3f direction{0, 0, 1};  ///< unit
    Color weight{0, 0,
                 0};    ///< all closures' value * |cosine| / density; singular: value * |cosine| / discrete probability
    float density = 0;  ///< of all non-singular lobes, per solid angle; 0 for singular samples
    LobeKind kind = LobeKind::Diffuse;  ///< that the ray counts as
    bool singular = false;              ///< mirror or clear glass: no light sampling can find it
    bool transmitted = false;           ///< went through the surface
    float eta = 1;                      ///< refraction: index on the viewer's side over that beyond; else 1
    float roughness = 0;                ///< of the lobe, 0..1: how wide the ray's differential opens
    /// Of a Subsurface lobe, else null: `direction` is the way into the body, where a walk begins. Lives as the
    /// closures.
    const Lobe* subsurface = nullptr;
    bool fibre = false;  ///< of a hair
};

/// How the smooth surface's own shadow darkens bumps of diffuse lobes.
enum class BumpShadow : uint8_t {
    None,
    /// By a cubic of how much of the light the smooth surface gets: M. J. Chiang, Y. K. Li, B. Burley, *Taming the
    /// Shadow Terminator*, 2019. Cycles up to 4.4.
    Cubic,
    /// As the facets of a GGX distribution shadow one another, the rougher the further the bump leans: A. Conty
    /// Estevez, P. Lecocq, C. Stein, *A Microfacet-Based Shadowing Function to Solve the Bump Terminator Problem*,
    /// 2019. Cycles since 4.5.
    Facets,
};

/// Which lobes' normals are turned until what they mirror clears the facet (`clearing_normal`, operations_closure.h).
enum class Clearing : uint8_t {
    None,
    Mirrors,  ///< of all but matte ones: diffuse, velvet, sheen, toon. Cycles since 3.6.
    All,      ///< and those that bumps bend. Cycles up to 3.5.
};

/// A share of light that comes here from another place, as the view from there in `direction`: Blender's Ray Portal
/// BSDF. Where several are mixed, the heaviest tells the place.
struct Portal {
    Color weight{0, 0, 0};
    Vec3f position{0, 0, 0};   ///< world units
    Vec3f direction{0, 0, 1};  ///< unit
};

class Closures {
  public:
    static constexpr int kMaxLobes = 16;

    Color emission{0, 0, 0};      ///< radiance towards the viewer
    Color transparency{0, 0, 0};  ///< share of light that goes straight through
    Portal portal;                ///< read where its weight is not black
    float holdout = 0;            ///< share that shows the film's emptiness
    /// The surface's own normal, unit, towards the viewer: diffuse lobes whose normal is another are darkened where it
    /// faces away from the light (lobes.h). Zero: none is. `clear` leaves it.
    Vec3f smooth_normal{0, 0, 0};
    BumpShadow bump_shadow = BumpShadow::Cubic;  ///< how; `clear` leaves it too
    Clearing clearing = Clearing::All;           ///< `clear` leaves it too
    /// Where the program writes its AOVs, by slot; empty: nowhere. Its caller sets it.
    std::span<Vec4f> aovs;
    MediumClosures medium;  ///< of a program of a volume; its emission is per world unit

    Closures() {}
    Closures(const Closures& other) { *this = other; }
    Closures& operator=(const Closures& other);

    void clear();
    /// Drops lobes of next to no weight; lobes that differ in weight alone become one. Past kMaxLobes the two of
    /// one type that are most alike become one, the heavier, with the weight of both. Numbers that are not finite
    /// become harmless ones; roughness too small for floating point, or an index too near 1 to spread, becomes
    /// singular.
    void add(const Lobe& lobe);
    /// Drops what is not finite.
    void add(const Portal& another);
    /// The share of light that is not scattered: straight through, or by the portal.
    Color unscattered() const { return transparency + portal.weight; }
    /// What arrives of a light behind the surface. As in Cycles, a portal blocks it, but where the surface is
    /// transparent beside it, light goes straight through both.
    Color shadow_transparency() const { return is_black(transparency) ? transparency : unscattered(); }
    /// Becomes a copy of `other`, which has no medium and one normal for all lobes, with `normal` in its place. The
    /// smooth normal and AOVs stay.
    void take_turned(const Closures& other, const Vec3f& normal);
    /// Gives microfacets at least the roughness `alpha`, and hair at least such widths.
    void widen(float alpha);
    /// Keeps what of the lobes makes no caustics: drops reflections that are not diffuse, refractions, or both.
    void drop_caustics(bool reflective, bool refractive);
    int size() const { return count_; }
    const Lobe& operator[](int i) const { return lobes_[i]; }

    /// `facet_normal` decides on which side a direction lies, so that no light leaks through bumped normals.
    /// Sum of value * |cosine| of all non-singular lobes of `kind` (of all without one) from `incoming` (towards the
    /// light).
    Color evaluate(const Vec3f& outgoing, const Vec3f& incoming, const Vec3f& facet_normal) const;
    Color evaluate(const Vec3f& outgoing, const Vec3f& incoming, const Vec3f& facet_normal, LobeKind kind) const;
    /// Density per solid angle with which `sample` gives `incoming`; singular lobes count 0.
    float density(const Vec3f& outgoing, const Vec3f& incoming, const Vec3f& facet_normal) const;
    /// A direction; `random` in [0,1)³. x chooses the lobe, what the choice leaves of it and y the direction. z counts
    /// where `needs_third_number` alone. Empty where the sample fails or carries nothing.
    std::optional<LobeSample> sample(const ClosureView& view, const Vec3f& facet_normal, const Vec3f& random) const;
    std::optional<LobeSample> sample(const Vec3f& outgoing, const Vec3f& facet_normal, const Vec3f& random) const;
    /// Whether `sample` chooses more than a lobe and a direction: between what rough glass does, or ways through hair.
    bool needs_third_number() const;
    /// The side from which sampled lights can light the lobes: the normal of one of them; zero where some are lit from
    /// both sides, or none is.
    Vec3f lit_side() const;
    /// True if any lobe can be lit by sampled lights.
    bool has_smooth_lobes() const;
    /// Albedo (directional reflectance, approximate for microfacets) of the lobes of `kind`, for the colour passes.
    Color albedo(const Vec3f& outgoing, LobeKind kind) const;

    /// Value * |cosine| and density of all non-singular lobes together, for the cost of one of the two.
    struct Evaluation {
        Color value{0, 0, 0};
        float density = 0;
    };
    Evaluation evaluate_with_density(const ClosureView& view, const Vec3f& incoming, const Vec3f& facet_normal) const;
    /// The same with a value for each kind.
    struct EvaluationByKind {
        std::array<Color, kLobeKindCount> values{Color(0.0f), Color(0.0f), Color(0.0f)};
        float density = 0;
    };
    EvaluationByKind evaluate_by_kind(const ClosureView& view, const Vec3f& incoming, const Vec3f& facet_normal) const;

  private:
    /// Room that costs nothing to make: the first `count_` are there.
    union {
        Lobe lobes_[kMaxLobes];
    };
    static_assert(std::is_trivially_destructible_v<Lobe>);
    int count_ = 0;

    void join_most_alike(const Lobe& lobe);
};

}  // namespace rayleaf
