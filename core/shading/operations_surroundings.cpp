#include "shading/operations_surroundings.h"

#include "shading/operations_closure.h"
#include "shading/operations_input.h"

namespace rayleaf {
namespace {

bool has_flag(std::span<const int32_t> ints, size_t i) {
    return i < ints.size() && ints[i] != 0;
}

Vec4f ambient_occlusion_value(const Operands& operands, std::span<const int32_t> ints, const ShadingInputs& inputs,
                              const ProbeNumbers& numbers) {
    const Vec3f normal = facing_normal(inputs);
    Surroundings::Openness asked;
    asked.axis = operands.connected(1) ? normalized_or(operands.vector(1), normal) : normal;
    if (has_flag(ints, 1)) asked.axis = -asked.axis;
    asked.distance = operands.scalar(0);
    asked.rays = ints[0];
    asked.only_local = has_flag(ints, 2);
    return spread(inputs.surroundings->openness(*inputs.point, asked, numbers));
}

Vec4f bevel_value(const Operands& operands, int rays, const ShadingInputs& inputs, const ProbeNumbers& numbers) {
    const Vec3f own = facing_normal(inputs);
    const Vec3f normal = operands.connected(1) ? normalized_or(operands.vector(1), own) : own;
    const Vec3f around = inputs.surroundings->rounded_normal(*inputs.point, operands.scalar(0), rays, numbers);
    // What bent the normal before stays.
    return extended(normalized_or(normal + (is_backfacing(inputs) ? -around : around) - own, normal));
}

/// Lengths are counted in those of the direction, as in Cycles.
Vec4f raycast_value(const Operands& operands, std::span<const int32_t> ints, const ShadingInputs& inputs) {
    const Vec3f direction = operands.vector(1);
    const float scale = direction.length(), length = operands.scalar(2);
    std::optional<Surroundings::Met> met;
    if (inputs.surroundings != nullptr && inputs.point != nullptr && scale > 0.0f && std::isfinite(scale))
        met = inputs.surroundings->cast(
            *inputs.point, {operands.vector(0), direction * (1.0f / scale), length * scale, has_flag(ints, 1)});
    if (ints[0] == 1) return extended(met ? met->normal : Vec3f(0.0f));
    return met ? Vec4f(1.0f, met->own ? 1.0f : 0.0f, met->distance / scale, 1.0f) : Vec4f(0.0f, 0.0f, length, 1.0f);
}

}  // namespace

Vec4f surroundings_value(Operation operation, const Operands& operands, std::span<const int32_t> ints,
                         const ShadingInputs& inputs, uint32_t tag) {
    if (operation == Operation::raycast) return raycast_value(operands, ints, inputs);
    const bool is_bevel = operation == Operation::bevel;
    if (inputs.surroundings == nullptr || inputs.point == nullptr) {
        if (!is_bevel) return spread(1.0f);
        const Vec3f own = facing_normal(inputs);
        return extended(operands.connected(1) ? normalized_or(operands.vector(1), own) : own);
    }
    ProbeNumbers numbers = inputs.probes;
    numbers.tag = hash_combine(numbers.tag, tag);
    return is_bevel ? bevel_value(operands, ints[0], inputs, numbers)
                    : ambient_occlusion_value(operands, ints, inputs, numbers);
}

}  // namespace rayleaf
