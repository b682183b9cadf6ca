#include "shading/even_closures.h"

#include "shading/operands.h"
#include "shading/operations_closure.h"
#include "shading/operations_input.h"
#include "shading/variants.h"

namespace rayleaf {
namespace {

/// Whether an operand is left out, or a constant zero.
bool is_zero(const Operands& operands, uint32_t i) {
    return operands.scalar(i) == 0.0f;
}

bool loses_energy(uint8_t variant) {
    return static_cast<MicrofacetVariant>(variant) != MicrofacetVariant::MULTI_GGX;
}

}  // namespace

bool turns_alone(Operation operation, uint8_t variant, const Operands& operands) {
    const auto bends = [&](uint32_t normal) { return operands.connected(normal); };
    switch (operation) {
        case Operation::emission:
        case Operation::background:
        case Operation::transparent:
        case Operation::holdout:
            return true;
        case Operation::translucent:
            return !bends(2);
        case Operation::diffuse:
        case Operation::velvet:
            return !bends(3);
        case Operation::toon:
            return !bends(4);
        case Operation::glossy:
            return !bends(3) && is_zero(operands, 4) && loses_energy(variant);
        case Operation::refraction:
            return !bends(4);
        case Operation::glass:
            return !bends(4) && loses_energy(variant);
        case Operation::subsurface:
            return !bends(6);
        case Operation::principled:
            return !bends(18) && !bends(19) && is_zero(operands, 6) &&
                   static_cast<PrincipledVariant>(variant) != PrincipledVariant::MULTI_GGX;
        default:
            return false;
    }
}

EvenClosures::EvenClosures(const std::function<void(const ShadingInputs&, Closures&)>& run) {
    for (const bool behind : {false, true})
        for (const bool after_diffuse : {false, true}) {
            SurfacePoint point;
            point.facet_normal = point.normal = Vec3f(0.0f, 0.0f, behind ? -1.0f : 1.0f);
            ShadingInputs inputs;
            inputs.point = &point;
            inputs.outgoing = Vec3f(0.0f, 0.0f, 1.0f);
            inputs.path.diffuse_depth = after_diffuse ? 1 : 0;
            run(inputs, of[behind ? 1 : 0][after_diffuse ? 1 : 0]);
        }
}

std::optional<Color> EvenClosures::even_emission() const {
    const Color& first = of[0][0].emission;
    for (const auto& side : of)
        for (const Closures& closures : side)
            if (closures.emission != first) return std::nullopt;
    return first;
}

bool EvenClosures::copy(const ShadingInputs& inputs, Closures& result) const {
    const size_t behind = is_backfacing(inputs) ? 1 : 0, after_diffuse = inputs.path.diffuse_depth > 0 ? 1 : 0;
    const Closures& even = of[behind][after_diffuse];
    const Vec3f own = facing_normal(inputs);
    Vec3f normal = own;
    if (even.clearing != Clearing::None) normal = clearing_normal(facing_facet_normal(inputs), inputs.outgoing, own);
    if (even.clearing == Clearing::Mirrors && normal != own) return false;
    result.take_turned(even, normal);
    result.smooth_normal = own;
    result.bump_shadow = even.bump_shadow;
    result.clearing = even.clearing;
    return true;
}

}  // namespace rayleaf
