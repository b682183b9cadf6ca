#include "shading/operations_hair.h"

#include "shading/lobe_fibre.h"
#include "shading/lobe_hair_facets.h"
#include "shading/operations_closure.h"
#include "shading/operations_input.h"
#include "shading/variants.h"

namespace rayleaf {
namespace {

/// Of hair; as Cycles.
constexpr float kLeastFibreRoughness = 0.001f;

bool is_strand(const ShadingInputs& inputs) {
    return inputs.point->shape != nullptr && inputs.point->shape->kind() == ShapeKind::Strands;
}

Lobe hair_lobe(HairVariant variant, const Operands& operands, const ShadingInputs& inputs) {
    const bool reflects = variant == HairVariant::REFLECTION;
    Lobe lobe;
    lobe.type = reflects ? LobeType::HairReflection : LobeType::HairTransmission;
    lobe.kind = reflects ? LobeKind::Glossy : LobeKind::Transmission;
    lobe.weight = weight_of(operands) * operands.vector(1);
    lobe.normal = facing_normal(inputs);
    lobe.tilt = -operands.scalar(2);
    lobe.alpha_x = std::clamp(operands.scalar(3), kLeastFibreRoughness, 1.0f);
    lobe.alpha_y = std::clamp(operands.scalar(4), kLeastFibreRoughness, 1.0f);
    if (operands.connected(5)) {
        lobe.tangent = operands.vector(5);
    } else {  // on other surfaces hair lies along V
        const bool on_strand = is_strand(inputs);
        lobe.tangent = on_strand ? inputs.point->dp_du : inputs.point->dp_dv;
        if (!on_strand) lobe.tilt = 0.0f;
    }
    return lobe;
}

/// By how much a strand differs from others: three operands from `first`, its random number and the amounts for colour
/// and roughness.
struct StrandVariation {
    float color_factor, roughness_factor;

    StrandVariation(const Operands& operands, uint32_t first) {
        const float deviation = 2.0f * (operands.scalar(first) - 0.5f);  // -1..1
        color_factor = 1.0f + deviation * saturate(operands.scalar(first + 1));
        roughness_factor = 1.0f + deviation * operands.scalar(first + 2);
    }
};

Color fibre_absorption(HairColoring coloring, const Operands& operands, float color_factor, float radial) {
    if (coloring == HairColoring::ABSORPTION) return operands.vector(1);
    if (coloring == HairColoring::COLOR) return absorption_of_color(operands.vector(1), radial);
    return absorption_of_melanin(operands.scalar(2) * color_factor, operands.scalar(3)) +
           absorption_of_color(operands.vector(4), radial);
}

/// What both models have in common: where the fibre is met.
Lobe fibre_at_point(LobeType type, const Operands& operands, const ShadingInputs& inputs) {
    Lobe lobe;
    lobe.type = type;
    lobe.kind = LobeKind::Glossy;
    lobe.weight = weight_of(operands);
    lobe.normal = facing_normal(inputs);
    lobe.tangent = normalized_or(inputs.point->dp_du, Vec3f(0, 0, 1));
    lobe.across = fibre_offset(lobe.tangent, inputs.outgoing, lobe.normal);
    return lobe;
}

Lobe hair_fibre_lobe(HairColoring coloring, const Operands& operands, const ShadingInputs& inputs) {
    const auto limited = [](float roughness) { return std::clamp(roughness, kLeastFibreRoughness, 1.0f); };
    const StrandVariation variation(operands, 10);
    const float roughness = limited(operands.scalar(5) * variation.roughness_factor);
    const float radial = operands.scalar(6) * variation.roughness_factor;
    Lobe lobe = fibre_at_point(LobeType::HairFibre, operands, inputs);
    lobe.alpha_x = longitudinal_variance(roughness);
    lobe.alpha_y = azimuthal_scale(limited(radial));
    lobe.roughness = longitudinal_variance(limited(roughness * (1.0f - saturate(operands.scalar(7)))));
    lobe.ior = operands.scalar(8);
    lobe.tilt = operands.scalar(9);
    lobe.fresnel_0 = fibre_absorption(coloring, operands, variation.color_factor, radial);
    return lobe;
}

/// Half the width of a pixel at a strand that the camera sees, over the strand's radius; 1 for other rays and shapes.
/// `thickness` in object space, `along` unit in world space.
float half_pixel_of_strand(const ShadingInputs& inputs, float thickness, const Vec3f& along) {
    if (!inputs.path.camera || !is_strand(inputs)) return 1.0f;
    const auto shrinks = static_cast<float>(inputs.world_to_object().vector(Vec3d(along)).length());
    const float pixel = inputs.differential.width_across(inputs.outgoing) * shrinks;
    return thickness > 0.0f ? pixel / thickness : 1.0f;
}

/// Of how many offsets a value is the mean at most: those of a ray that was scattered count little beside other noise.
constexpr float kOffsetsForCamera = 16.0f, kOffsets = 4.0f;

/// Adds the lobe; what passes beside the fibre instead, where its cross section is not round.
void add_hair_facets(HairColoring coloring, const Operands& operands, const ShadingInputs& inputs, Closures& closures) {
    const StrandVariation variation(operands, 8);
    const float roughness = operands.scalar(5) * variation.roughness_factor;
    Lobe lobe = fibre_at_point(LobeType::HairFacets, operands, inputs);
    lobe.alpha_x = roughness;
    lobe.ior = operands.scalar(6);
    lobe.tilt = -operands.scalar(7);
    lobe.fresnel_0 = fibre_absorption(coloring, operands, variation.color_factor, roughness);
    lobe.refracted = Color(operands.scalar(12), operands.scalar(13), operands.scalar(14));
    if (is_black(lobe.refracted)) return;
    lobe.alpha_y = inputs.path.camera ? kOffsetsForCamera : kOffsets;
    lobe.softness = half_pixel_of_strand(inputs, operands.scalar(16), lobe.tangent);
    lobe.roughness = 1.0f;
    const float ratio = operands.scalar(kRatioOfHairAxes);
    if (!is_strand(inputs) || ratio == 1.0f) {
        closures.add(lobe);
        return;
    }
    // Above 1 the same axis stays the longer one, as in Cycles.
    lobe.roughness = ratio > 1.0f ? 1.0f / ratio : ratio;
    lobe.radius = Vec3f(inputs.object_to_world().vector(Vec3d(operands.vector(15))));
    if (passes_hair_facets(lobe, inputs.outgoing))
        closures.transparency += lobe.weight;
    else
        closures.add(lobe);
}

}  // namespace

void add_hair(Operation operation, uint8_t variant, const Operands& operands, const ShadingInputs& inputs,
              Closures& closures) {
    if (operation == Operation::hair)
        closures.add(hair_lobe(static_cast<HairVariant>(variant), operands, inputs));
    else if (operation == Operation::hair_fibre)
        closures.add(hair_fibre_lobe(static_cast<HairColoring>(variant), operands, inputs));
    else
        add_hair_facets(static_cast<HairColoring>(variant), operands, inputs, closures);
}

}  // namespace rayleaf
