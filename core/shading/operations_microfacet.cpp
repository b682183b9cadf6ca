#include "shading/operations_microfacet.h"

#include "shading/fresnel.h"
#include "shading/microfacet_albedo.h"
#include "shading/operations_closure.h"
#include "shading/operations_input.h"
#include "shading/operations_math.h"

namespace rayleaf {
namespace {

/// 1: joint; without a number, separate.
Masking masking_of(std::span<const int32_t> ints) {
    return !ints.empty() && ints[0] != 0 ? Masking::Joint : Masking::Separate;
}

void set_roughness(Lobe& lobe, MicrofacetVariant variant, float roughness) {
    const float clamped = saturate(roughness);
    const float alpha = variant == MicrofacetVariant::SHARP ? 0.0f : clamped * clamped;
    lobe.alpha_x = lobe.alpha_y = alpha;
    lobe.stays_sharp = variant == MicrofacetVariant::SHARP;
    // Ashikhmin-Shirley's lobes have no tails, like Beckmann's.
    const bool beckmann = variant == MicrofacetVariant::BECKMANN || variant == MicrofacetVariant::ASHIKHMIN_SHIRLEY;
    lobe.distribution = beckmann ? MicrofacetDistribution::Beckmann : MicrofacetDistribution::Ggx;
}

Lobe glossy_lobe(MicrofacetVariant variant, const Operands& operands, Masking masking, const ShadingInputs& inputs,
                 Clearing clearing) {
    Lobe lobe;
    lobe.type = LobeType::Reflection;
    lobe.kind = LobeKind::Glossy;
    lobe.masking = masking;
    lobe.normal = mirror_normal(operands, 3, inputs, clearing);
    set_roughness(lobe, variant, operands.scalar(2));
    const Color color = operands.vector(1);
    lobe.weight = weight_of(operands) * color;
    const float anisotropy = std::clamp(operands.scalar(4), -0.99f, 0.99f);  // Cycles' limits
    if (anisotropy != 0.0f) {
        // Along the tangent and across: one is made smoother, the other rougher.
        const float narrow = 1.0f - std::abs(anisotropy);
        lobe.alpha_x *= anisotropy > 0.0f ? narrow : 1.0f / narrow;
        lobe.alpha_y *= anisotropy > 0.0f ? 1.0f / narrow : narrow;
        lobe.tangent = rotated(operands.vector(6, inputs.point->dp_du), lobe.normal, operands.scalar(5) * 2.0f * kPi);
    }
    if (variant == MicrofacetVariant::MULTI_GGX) {
        const float alpha = even_alpha(lobe.alpha_x, lobe.alpha_y);
        const float albedo = ggx_reflection_albedo(alpha, std::max(lobe.normal.dot(inputs.outgoing), 0.0f), masking);
        lobe.weight = lobe.weight * energy_compensation(color, albedo);
    }
    return lobe;
}

Lobe refraction_lobe(MicrofacetVariant variant, const Operands& operands, Masking masking, const ShadingInputs& inputs,
                     Clearing clearing) {
    Lobe lobe;
    lobe.type = LobeType::Refraction;
    lobe.kind = LobeKind::Transmission;
    lobe.masking = masking;
    lobe.weight = weight_of(operands) * operands.vector(1);
    lobe.normal = mirror_normal(operands, 4, inputs, clearing);
    lobe.ior = index_beyond(operands.scalar(3), inputs);
    set_roughness(lobe, variant, operands.scalar(2));
    return lobe;
}

Lobe glass_lobe(MicrofacetVariant variant, const Operands& operands, std::span<const int32_t> ints,
                const ShadingInputs& inputs, Clearing clearing) {
    const Masking masking = masking_of(ints);
    Lobe lobe = refraction_lobe(variant, operands, masking, inputs, clearing);
    lobe.type = LobeType::Glass;
    lobe.fresnel_at_normal = ints.size() > 1 && ints[1] != 0;
    if (variant == MicrofacetVariant::MULTI_GGX) {
        const float cosine = std::max(lobe.normal.dot(inputs.outgoing), 0.0f);
        lobe.weight = lobe.weight * energy_compensation(operands.vector(1),
                                                        ggx_glass_albedo(lobe.alpha_x, cosine, lobe.ior, masking));
    }
    const ThinFilm film{operands.scalar(5), operands.scalar(6, lobe.film.ior)};
    if (film.thickness > 0.0f) {
        lobe.film = film;
        if (is_backfacing(inputs)) lobe.film.ior *= lobe.ior;  // which is 1 over that of the glass
        lobe.fresnel = Lobe::Fresnel::Dielectric;
    }
    return lobe;
}

/// The reflectance of a metal over all directions; that of a conductor by the metal which it is like (Cycles'
/// estimate).
Color mean_reflectance(const Lobe& lobe) {
    if (lobe.fresnel == Lobe::Fresnel::Metal) return mean_metal_fresnel(lobe.fresnel_0, lobe.radius);
    const Color straight = conductor_fresnel(lobe.fresnel_0, lobe.radius, 1.0f);
    const Color edge = conductor_fresnel(lobe.fresnel_0, lobe.radius, kMetalEdge);
    return mean_metal_fresnel(straight, metal_dip(straight, edge / metal_edge_without_dip(straight)));
}

Lobe metal_lobe(MicrofacetVariant variant, const Operands& operands, std::span<const int32_t> ints,
                const ShadingInputs& inputs, Clearing clearing) {
    Lobe lobe;
    lobe.type = LobeType::Reflection;
    lobe.kind = LobeKind::Glossy;
    lobe.masking = Masking::Joint;
    lobe.normal = mirror_normal(operands, 4, inputs, clearing);
    lobe.weight = weight_of(operands);
    if (!ints.empty() && ints[0] != 0) {
        lobe.fresnel = Lobe::Fresnel::Conductor;
        // Beyond, Fresnel's formulas divide nothing by nothing, or what overflows by what overflows.
        constexpr float kLeast = 1e-4f, kMost = 1e4f;
        const Color index = operands.vector(1), extinction = operands.vector(2);
        for (int c = 0; c < 3; ++c) {
            lobe.fresnel_0[c] = std::clamp(index[c], kLeast, kMost);
            lobe.radius[c] = std::clamp(extinction[c], 0.0f, kMost);
        }
    } else {
        lobe.fresnel = Lobe::Fresnel::Metal;
        lobe.fresnel_0 = saturate(operands.vector(1));
        lobe.radius = metal_dip(lobe.fresnel_0, saturate(operands.vector(2)));
    }
    set_roughness(lobe, variant, operands.scalar(3));
    if (const float anisotropy = saturate(operands.scalar(5)); anisotropy != 0.0f) {
        const float aspect = std::sqrt(1.0f - 0.9f * anisotropy);
        lobe.alpha_x /= aspect;
        lobe.alpha_y *= aspect;
        lobe.tangent = rotated(operands.vector(7, inputs.point->dp_du), lobe.normal, operands.scalar(6) * 2.0f * kPi);
    }
    if (variant == MicrofacetVariant::MULTI_GGX) {
        const float alpha = even_alpha(lobe.alpha_x, lobe.alpha_y);
        const float albedo =
            ggx_reflection_albedo(alpha, std::max(lobe.normal.dot(inputs.outgoing), 0.0f), Masking::Joint);
        const Color again = repeated_fresnel(mean_reflectance(lobe), ggx_mean_albedo(alpha));
        lobe.weight = lobe.weight * energy_compensation(again, albedo);
    }
    lobe.film = {operands.scalar(8), operands.scalar(9, lobe.film.ior)};
    return lobe;
}

}  // namespace

void add_microfacets(Operation operation, MicrofacetVariant variant, const Operands& operands,
                     std::span<const int32_t> ints, const ShadingInputs& inputs, Closures& closures) {
    switch (operation) {
        case Operation::glossy:
            return closures.add(glossy_lobe(variant, operands, masking_of(ints), inputs, closures.clearing));
        case Operation::refraction:
            return closures.add(refraction_lobe(variant, operands, masking_of(ints), inputs, closures.clearing));
        case Operation::glass:
            return closures.add(glass_lobe(variant, operands, ints, inputs, closures.clearing));
        default:
            return closures.add(metal_lobe(variant, operands, ints, inputs, closures.clearing));
    }
}

}  // namespace rayleaf
