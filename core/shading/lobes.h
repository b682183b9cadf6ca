// One lobe at a time: value, density, sampling. Used by the closures of a point only (shading/closures.h).
#pragma once

#include "base/float4.h"
#include "shading/closure_view.h"

#include <optional>

namespace rayleaf {

/// On which side of the facet, seen from the viewer, a direction lies.
enum class Side : uint8_t { Reflected, Transmitted };

inline bool is_singular(const Lobe& lobe) {
    const bool microfacets = lobe.type == LobeType::Reflection || lobe.type == LobeType::Refraction ||
                             lobe.type == LobeType::Glass || lobe.type == LobeType::Sheet;
    return microfacets && lobe.alpha_x == 0.0f;
}
inline bool is_fibre(const Lobe& lobe) {
    return lobe.type == LobeType::HairReflection || lobe.type == LobeType::HairTransmission ||
           lobe.type == LobeType::HairFibre || lobe.type == LobeType::HairFacets;
}
/// Whether the lobe is sampled by itself: its density is unknown, so that other lobes' samples cannot stand for it, nor
/// its own for them. Light sampling is weighed against it by a density that is agreed upon.
inline bool is_alone(const Lobe& lobe) {
    return lobe.type == LobeType::HairFacets;
}
/// That density, per solid angle; as in Cycles.
inline constexpr float kDensityAlone = 1.0f;
inline bool refracts(const Lobe& lobe) {
    return lobe.type == LobeType::Refraction || lobe.type == LobeType::Glass;
}
/// Whether the lobe is of microfacets.
inline bool has_facets(const Lobe& lobe) {
    return refracts(lobe) || lobe.type == LobeType::Reflection || lobe.type == LobeType::Sheet ||
           lobe.type == LobeType::Clearcoat;
}

/// Two directions at a point, and what many lobes ask of them.
struct DirectionPair {
    alignas(16) Vec3f outgoing;
    alignas(16) Vec3f incoming;
    Side side;
    // Where a lobe asks for halves, and on the viewer's side; else 0.
    alignas(16) Vec3f half{0, 0, 0};  ///< between both, unit; zero where they are opposite
    float cosine_half = 0;            ///< of either's angle to it

    DirectionPair(const Vec3f& towards_viewer, const Vec3f& towards_light, Side lit, bool halves)
        : outgoing(towards_viewer), incoming(towards_light), side(lit) {
        if (!halves || side != Side::Reflected) return;
        const Vec3f sum = outgoing + incoming;
        const float length = std::sqrt(sum.length2());
        if (length > 0.0f) half = sum * (1.0f / length);
        cosine_half = 0.5f * length;
    }
};
/// Whether a lobe asks for `DirectionPair::half`.
inline bool uses_half(const Lobe& lobe) {
    switch (lobe.type) {
        case LobeType::Reflection:
        case LobeType::Glass:
            return !is_singular(lobe);
        case LobeType::Clearcoat:
        case LobeType::Sheen:
        case LobeType::Velvet:
        case LobeType::PrincipledDiffuse:
        case LobeType::RetroReflection:
            return true;
        default:
            return false;
    }
}

/// What a lobe makes of light from a direction, in one register.
struct LobeValue {
    Float4 numbers{0, 0, 0, 0};

    LobeValue() = default;
    /// Weighted value * |cosine|; per solid angle, once the lobe has been chosen.
    LobeValue(const Color& value, float density) : numbers{value.x, value.y, value.z, density} {}
    Color value() const { return {numbers[0], numbers[1], numbers[2]}; }
    float density() const { return numbers[3]; }
};

/// A direction chosen by one lobe.
struct LobeDirection {
    Vec3f direction;
    /// What the choice tells of the lobe's own value there, if that is `weighed`: weighted value * |cosine| / density,
    /// and the density; of singular lobes, over the discrete probability, and 0.
    Color weight{0, 0, 0};
    float density = 0;
    float eta = 1;                ///< of a refraction: index on the viewer's side over that beyond
    Side side = Side::Reflected;  ///< of a weighed one, by the lobe's normal
    bool weighed = false;
    bool through = false;  ///< of hair: came out of the fibre, not off it; not of HairFacets, as in Cycles
};

/// What is left of light from `incoming` that meets a bump: smoothly down to 0 where the smooth surface is in its own
/// shadow. `kind` is not None.
float bump_shadow(BumpShadow kind, const Vec3f& smooth, const Vec3f& bent, const Vec3f& incoming);
/// Whether that darkens a lobe of these closures.
bool is_bent(const Lobe& lobe, const Closures& of);
/// 0 for singular lobes.
LobeValue evaluate_lobe(const Lobe& lobe, const LobeView& view, const DirectionPair& pair);
/// `random` in [0,1)³; z as in Closures::needs_third_number. Empty where there is no such direction (total internal
/// reflection, masked).
std::optional<LobeDirection> sample_lobe(const Lobe& lobe, const LobeView& view, const Vec3f& outgoing,
                                         const Vec3f& random);
/// How often a lobe seen under `cosine` is chosen, relative to others; positive wherever its value is.
float choice_weight(const Lobe& lobe, float cosine);
/// What its glint adds to that.
float glint_weight(const Lobe& lobe, const LobeView& view);
/// Sets `view`, but for its probability, to the lobe seen from `outgoing`; not bent.
void look_at(const Lobe& lobe, const Vec3f& outgoing, LobeView& view);
/// Weighted albedo that falls in the family `kind`; Fresnel taken at the lobe's normal.
Color lobe_albedo(const Lobe& lobe, const Vec3f& outgoing, LobeKind kind);
/// The family of a direction scattered to `side`: the lobe's own, but for glass, which has two.
LobeKind kind_of(const Lobe& lobe, Side side);
/// What a ray counts as that goes on this way: velvet's light is Glossy, but its rays are Diffuse, as in Cycles.
LobeKind kind_of_ray(const Lobe& lobe, Side side);
/// 0..1: how wide the lobe is.
float lobe_width(const Lobe& lobe);

}  // namespace rayleaf
