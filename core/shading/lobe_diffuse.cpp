#include "shading/lobe_diffuse.h"

#include "shading/fresnel.h"
#include "shading/lobe_frame.h"

#include <cfloat>

namespace rayleaf {
namespace {

constexpr float kInversePi = 1.0f / kPi;

/// Oren-Nayar in Fujii's form ("A tiny improvement of Oren-Nayar reflectance model"), the one Cycles uses; times the
/// cosine. `sigma` 0..1.
float oren_nayar(float sigma, float cos_i, float cos_o, float cos_between) {
    if (sigma == 0.0f) return cos_i * kInversePi;
    const float divisor = 1.0f / (kPi + (3.0f * kPi - 4.0f) / 6.0f * sigma);
    const float seen = std::max(cos_o, 0.0f);
    float t = cos_between - cos_i * seen;
    if (t > 0.0f) t /= std::max(cos_i, seen) + FLT_MIN;
    return cos_i * divisor * (1.0f + sigma * t);
}

/// Share of light from everywhere that Fujii's form reflects once towards `cosine`, but for the part that does not
/// depend on it and for `sigma` (Portsmouth, Kutz, Hill: "EON: A Practical Energy-Preserving Rough Diffuse BRDF", 2024,
/// equation 10).
float rough_share(float cosine) {
    constexpr float kGrazing = 1e-6f, kTwoThirds = 2.0f / 3.0f;
    if (cosine < kGrazing) return 0.5f * kPi - kTwoThirds - cosine;
    const float sine = std::sqrt(std::max(1.0f - cosine * cosine, 0.0f));
    const float angle = std::acos(std::min(cosine, 1.0f));
    return sine * (angle - kTwoThirds - sine * cosine) + kTwoThirds * (sine / cosine) * (1.0f - sine * sine * sine);
}

/// What rough surfaces of an albedo reflect more than once, over the albedo, times the cosine (the same, section 3,
/// with a factor of the albedo more, as Cycles has it).
Color repeated_oren_nayar(float sigma, const Color& albedo, float cos_i, float cos_o) {
    // Shares that are lost, over `slope`: those of next to no roughness are too small for the difference to 1.
    constexpr float kMost = (3.0f * kPi - 4.0f) / 6.0f, kMean = kMost - (2.0f * kPi - 5.6f) / 3.0f;
    const float slope = sigma / (kPi + kMost * sigma), lost = slope * kMean;
    const float lost_i = kMost - rough_share(cos_i), lost_o = kMost - rough_share(std::max(cos_o, 0.0f));
    const Color again = albedo * albedo * (1.0f - lost) / (Color(1.0f) - albedo * lost);
    return again * (cos_i / kPi * slope * lost_i * lost_o / kMean);
}

/// Disney diffuse with retro-reflection over Lambert's (Burley 2012, section 5.3); `cos2_half` is squared.
float disney_shape(float roughness, float cos_i, float cos_o, float cos2_half) {
    if (cos_o <= 0.0f) return 0.0f;
    const float grazing = 2.0f * roughness * cos2_half - 0.5f;
    return (1.0f + grazing * schlick_weight(cos_i)) * (1.0f + grazing * schlick_weight(cos_o));
}

/// Its part that is not Lambert's (Burley 2015, equation 4), times the cosine.
float disney_retro_reflection(float roughness, float cos_i, float cos_o, float cos_half) {
    if (cos_o <= 0.0f) return 0.0f;
    const float at_grazing = 2.0f * roughness * cos_half * cos_half;
    const float in = schlick_weight(cos_i), out = schlick_weight(cos_o);
    return cos_i * kInversePi * at_grazing * (in + out + in * out * (at_grazing - 1.0f));
}

/// Fibres that stand on the surface, tilted by about `sigma` (Ashikhmin, Premoze, Shirley, "A Microfacet-based BRDF
/// Generator", section 6, with Cycles' masking by V-shaped grooves); times the cosine.
float velvet(float sigma, float cos_i, float cos_o, float cos_normal_half, float cos_outgoing_half) {
    constexpr float kLeastSigma = 0.01f, kEdge = 1e-5f;
    if (!(cos_o > 0.0f) || cos_normal_half >= 1.0f - kEdge || cos_outgoing_half <= kEdge) return 0.0f;
    const float s = std::max(sigma, kLeastSigma), inverse = 1.0f / (s * s);
    const float groove = 2.0f * std::max(cos_normal_half / cos_outgoing_half, kEdge);
    const float masking = std::min(1.0f, groove * std::min(cos_o, cos_i));
    const float sine2 = 1.0f - cos_normal_half * cos_normal_half;
    const float fibres =
        std::exp(-cos_normal_half * cos_normal_half / sine2 * inverse) * inverse / (kPi * sine2 * sine2);
    return 0.25f * fibres * masking / cos_o;
}

/// Diffuse, rough or not.
Color evaluate_lambertian(const Lobe& lobe, float cos_i, float cos_o, float cos_between) {
    const Color value(oren_nayar(lobe.roughness, cos_i, cos_o, cos_between));
    if (!(lobe.roughness > 0.0f) || is_black(lobe.fresnel_0)) return lobe.weight * value;
    return lobe.weight * (value + repeated_oren_nayar(lobe.roughness, lobe.fresnel_0, cos_i, cos_o));
}

}  // namespace

LobeValue evaluate_diffuse_lobe(const Lobe& lobe, const LobeView& view, const DirectionPair& pair) {
    const bool translucent = lobe.type == LobeType::Translucent;
    if (translucent != (pair.side == Side::Transmitted)) return {};
    const float cos_i = lobe.normal.dot(pair.incoming) * (translucent ? -1.0f : 1.0f), cos_o = view.cosine;
    if (!(cos_i > 0.0f)) return {};
    const float density = cos_i * kInversePi;
    switch (lobe.type) {
        case LobeType::Translucent:
            return {lobe.weight * density, density};
        case LobeType::PrincipledDiffuse:
            return {lobe.weight *
                        (density * disney_shape(lobe.roughness, cos_i, cos_o, pair.cosine_half * pair.cosine_half)),
                    density};
        case LobeType::LambertExit:
            return {lobe.weight * (density * (1.0f - 0.5f * schlick_weight(cos_i))), density};
        case LobeType::Velvet: {
            const float cos_normal_half = std::abs(lobe.normal.dot(pair.half));
            return {lobe.weight * velvet(lobe.roughness, cos_i, cos_o, cos_normal_half, std::abs(pair.cosine_half)),
                    density};
        }
        case LobeType::RetroReflection:
            return {lobe.weight * disney_retro_reflection(lobe.roughness, cos_i, cos_o, pair.cosine_half), density};
        case LobeType::Sheen:  // Disney's has no 1 / pi
            return {lobe.weight * (cos_o > 0.0f ? cos_i * schlick_weight(pair.cosine_half) : 0.0f), density};
        default:
            return {evaluate_lambertian(lobe, cos_i, cos_o, pair.outgoing.dot(pair.incoming)), density};
    }
}

LobeDirection sample_diffuse_lobe(const Lobe& lobe, const LobeView& view, const Vec3f& outgoing, const Vec3f& random) {
    Vec3f local = cosine_hemisphere(random.x, random.y);
    LobeDirection result;
    result.density = local.z * kInversePi;
    result.weight = lobe.weight;
    if (lobe.type == LobeType::Translucent) {
        local.z = -local.z;
        result.side = Side::Transmitted;
    }
    result.direction = LobeFrame(lobe).to_world(local);
    if (lobe.type == LobeType::PrincipledDiffuse) {
        const float cos2_half = 0.5f + 0.5f * outgoing.dot(result.direction);
        result.weight *= disney_shape(lobe.roughness, local.z, view.cosine, cos2_half);
        result.weighed = true;
    } else {
        result.weighed =
            lobe.type == LobeType::Translucent || (lobe.type == LobeType::Diffuse && lobe.roughness == 0.0f);
    }
    return result;
}

}  // namespace rayleaf
