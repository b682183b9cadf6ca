#include "shading/operations_volume.h"

#include "shading/spectrum.h"
#include "shading/variants.h"

namespace rayleaf {
namespace {

Color rest_of(const Color& c) {
    return not_negative(Color(1.0f) - c);
}

/// The operand `i`, which says how much of something there is in a world unit.
float amount(const Operands& operands, uint32_t i) {
    return std::max(operands.scalar(i), 0.0f);
}

/// Light of a hot body by the law of Stefan and Boltzmann, in Cycles' unit: `share` 0 glows alike at any temperature.
Color blackbody_emission(float share, const Color& tint, float temperature) {
    constexpr float kSigma = 5.670373e-8f * 1e-6f / kPi;
    const float kelvins = std::max(temperature, 0.0f), squared = kelvins * kelvins;
    const float intensity = kSigma * (1.0f + (squared * squared - 1.0f) * share);
    return tint * blackbody_color(kelvins) * intensity;
}

void add_principled(const Operands& operands, const Color& weight, const ShadingInputs& inputs, Closures& closures) {
    const Color color = operands.vector(1), absorbed = not_negative(operands.vector(4));
    const Color density = weight * amount(operands, 2);
    closures.medium.add_scattering(color * density, draine_phase(operands.scalar(3), 0.0f));
    const Color absorption_root(std::sqrt(absorbed.x), std::sqrt(absorbed.y), std::sqrt(absorbed.z));
    closures.medium.add_extinction((color + rest_of(color) * rest_of(absorption_root)) * density);
    if (inputs.path.shadow) return;
    // Whole whatever its weight in a mixture, as in Cycles.
    closures.emission += operands.vector(6) * amount(operands, 5);
    const float blackbody = amount(operands, 7);
    if (blackbody > 0.0f) closures.emission += blackbody_emission(blackbody, operands.vector(8), operands.scalar(9));
}

void add_scattering(PhaseVariant variant, const Operands& operands, const Color& scattering, MediumClosures& medium) {
    switch (variant) {
        case PhaseVariant::HENYEY_GREENSTEIN:
            return medium.add_scattering(scattering, draine_phase(operands.scalar(3), 0.0f));
        case PhaseVariant::DRAINE:
            return medium.add_scattering(scattering, draine_phase(operands.scalar(3), operands.scalar(4)));
        case PhaseVariant::RAYLEIGH:
            return medium.add_scattering(scattering, draine_phase(0.0f, 1.0f));
        case PhaseVariant::FOURNIER_FORAND:
            return medium.add_scattering(scattering, fournier_forand_phase(operands.scalar(3), operands.scalar(4)));
        case PhaseVariant::MIE:
            for (const auto& [phase, share] : mie_phase(operands.scalar(3)))
                medium.add_scattering(scattering * share, phase);
            return;
    }
}

}  // namespace

void add_volume_closure(Operation operation, uint8_t variant, const Operands& operands, const ShadingInputs& inputs,
                        Closures& closures) {
    const Color weight = operands.vector(0, Color(1.0f));
    if (operation == Operation::volume_principled) return add_principled(operands, weight, inputs, closures);
    const Color density = weight * amount(operands, 2);
    if (operation == Operation::volume_absorption)
        return closures.medium.add_extinction(rest_of(operands.vector(1)) * density);
    add_scattering(static_cast<PhaseVariant>(variant), operands, operands.vector(1) * density, closures.medium);
    closures.medium.add_extinction(operands.vector(1) * density);
}

}  // namespace rayleaf
