// One lobe at a time: value, density, sampling. Used by the closures of a point only (shading/closures.h).
#pragma once

#include "shading/closures.h"

#include <optional>

namespace rayleaf {

/// On which side of the facet, seen from the viewer, a direction lies.
enum class Side : uint8_t { Reflected, Transmitted };

struct LobeValue {
    Color value{0, 0, 0};  ///< weighted value * |cosine|
    float density = 0;     ///< per solid angle, once the lobe has been chosen
};

/// A direction chosen by one lobe.
struct LobeDirection {
    Vec3f direction;
    Color weight{0, 0, 0};  ///< singular lobes: weighted value * |cosine| / discrete probability
    float eta = 1;          ///< of a refraction: index on the viewer's side over that beyond
    bool through = false;   ///< of hair: came out of the fibre, not off it
};

bool is_singular(const Lobe& lobe);
bool is_fibre(const Lobe& lobe);
/// Whether a lobe of a bent normal is darkened by `bump_shadow`: those that are as wide as the hemisphere, but for
/// velvet, as in Cycles.
bool is_shadowed_where_bent(const Lobe& lobe);
/// What is left of light from `incoming` that meets a bump: 1 where the bump's slope is in the light as the smooth
/// surface would be, and smoothly down to 0 where the smooth surface is in its own shadow (M. J. Chiang, Y. K. Li, B.
/// Burley: Taming the Shadow Terminator, 2019).
float bump_shadow(const Vec3f& smooth, const Vec3f& bent, const Vec3f& incoming);
/// 0 for singular lobes.
LobeValue evaluate_lobe(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& incoming, Side side);
/// `random` in [0,1)³; z as in Closures::needs_third_number. Empty where there is no such direction (total internal
/// reflection, masked).
std::optional<LobeDirection> sample_lobe(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& random);
/// How often the lobe should be chosen, relative to others; positive wherever the lobe's value is.
float choice_weight(const Lobe& lobe, const Vec3f& outgoing);
/// Weighted albedo that falls in the family `kind`; Fresnel taken at the lobe's normal.
Color lobe_albedo(const Lobe& lobe, const Vec3f& outgoing, LobeKind kind);
/// The family of a direction scattered to `side`: the lobe's own, but for glass, which has two.
LobeKind kind_of(const Lobe& lobe, Side side);
/// 0..1: how wide the lobe is.
float lobe_width(const Lobe& lobe);

}  // namespace rayleaf
