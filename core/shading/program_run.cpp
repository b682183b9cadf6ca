// Running a program: the interpreter.
#include "base/assert.h"
#include "shading/neighbour.h"
#include "shading/operands.h"
#include "shading/operations_closure.h"
#include "shading/operations_color.h"
#include "shading/operations_input.h"
#include "shading/operations_math.h"
#include "shading/operations_pattern.h"
#include "shading/operations_texture.h"
#include "shading/program.h"

namespace rayleaf {
namespace {

/// Programs up to this many registers run on the stack.
constexpr size_t kStackRegisters = 256;
/// The hit and its two neighbours.
constexpr size_t kPlaces = 3;
/// Cycles' weights of linear Rec. 709: the second row of its matrix to XYZ.
const Vec3f kLuminance(0.2126729f, 0.7151522f, 0.0721750f);

Vec4f math_operation(uint8_t variant, const Operands& operands, bool clamped) {
    const float value =
        math_value(static_cast<MathVariant>(variant), operands.scalar(0), operands.scalar(1), operands.scalar(2));
    return spread(clamped ? saturate(value) : value);
}

Vec4f mix_operation(uint8_t variant, const Operands& operands, bool clamp_factor, bool clamp_result) {
    const Vec3f factor = operands.vector(0);
    const Vec3f value = blend(static_cast<BlendVariant>(variant), clamp_factor ? saturate(factor) : factor,
                              operands.vector(1), operands.vector(2));
    return extended(clamp_result ? saturate(value) : value);
}

float component(const Vec4f& v, int i) {
    switch (i) {
        case 0:
            return v.x;
        case 1:
            return v.y;
        case 2:
            return v.z;
        default:
            return v.w;
    }
}

float finite(float x) {
    return std::isfinite(x) ? x : 0.0f;
}
Color finite_and_positive(const Color& c) {
    return {std::max(finite(c.x), 0.0f), std::max(finite(c.y), 0.0f), std::max(finite(c.z), 0.0f)};
}

}  // namespace

Operands Program::operands_of(const Instruction& instruction, const Vec4f* registers) const {
    return {registers, operands_.data() + instruction.first_operand, instruction.operand_count};
}

std::span<const int32_t> Program::ints_of(const Instruction& instruction) const {
    return {ints_.data() + instruction.first_int, instruction.int_count};
}

Vec4f Program::arithmetic(const Instruction& instruction, const Operands& operands) const {
    const std::span<const int32_t> ints = ints_of(instruction);
    const auto flag = [&](size_t i) { return i < ints.size() && ints[i] != 0; };
    const uint8_t variant = instruction.variant;
    switch (instruction.operation) {
        case Operation::math:
            return math_operation(variant, operands, flag(0));
        case Operation::vector_math:
            return vector_math_value(static_cast<VectorMathVariant>(variant), operands.vector(0), operands.vector(1),
                                     operands.vector(2), operands.scalar(3));
        case Operation::mix:
            return mix_operation(variant, operands, flag(0), flag(1));
        case Operation::clamp:
            return spread(clamp_value(static_cast<ClampVariant>(variant), operands.scalar(0), operands.scalar(1),
                                      operands.scalar(2)));
        case Operation::map_range:
            return spread(map_range_value(static_cast<MapRangeVariant>(variant), operands, flag(0)));
        case Operation::mapping:
            return extended(mapping_value(static_cast<MappingVariant>(variant), operands.vector(0), operands.vector(1),
                                          operands.vector(2), operands.vector(3, Vec3f(1.0f))));
        case Operation::component:
            return spread(operands.connected(0) ? component(operands.value(0), ints[0]) : 0.0f);
        case Operation::combine:
            return Vec4f(operands.scalar(0), operands.scalar(1), operands.scalar(2), operands.scalar(3, 1.0f));
        case Operation::luminance:
            return spread(operands.vector(0).dot(kLuminance));
        case Operation::average: {
            const Vec3f v = operands.vector(0);
            return spread((v.x + v.y + v.z) / 3.0f);
        }
        case Operation::rgb_to_hsv:
            return extended(rgb_to_hsv(operands.vector(0)));
        case Operation::hsv_to_rgb:
            return extended(hsv_to_rgb(operands.vector(0)));
        case Operation::rgb_to_hsl:
            return extended(rgb_to_hsl(operands.vector(0)));
        case Operation::hsl_to_rgb:
            return extended(hsl_to_rgb(operands.vector(0)));
        case Operation::gamma:
            return extended(gamma_correct(operands.vector(0), operands.scalar(1)));
        case Operation::invert: {
            const Vec3f color = operands.vector(1);
            return extended(color + (Vec3f(1.0f) - color * 2.0f) * operands.scalar(0));
        }
        case Operation::bright_contrast:
            return extended(bright_contrast(operands.vector(0), operands.scalar(1), operands.scalar(2)));
        case Operation::hue_saturation:
            return extended(hue_saturation(operands.vector(4), operands.scalar(0), operands.scalar(1),
                                           operands.scalar(2), operands.scalar(3)));
        case Operation::table:
            return table_value({floats_.data() + instruction.first_float, instruction.float_count}, operands.scalar(0),
                               flag(0));
        default:
            return pattern_value(instruction.operation, variant, operands, ints);
    }
}

Vec4f Program::value_at(const Instruction& instruction, const Vec4f* registers, const ShadingInputs& inputs) const {
    const Operands operands = operands_of(instruction, registers);
    if (operation_info(instruction.operation).family == OperationFamily::Input)
        return input_value(instruction.operation, instruction.variant, operands, ints_of(instruction), inputs);
    return arithmetic(instruction, operands);
}

void Program::run(const ShadingInputs& inputs, Vec4f* registers, Closures& result) const {
    std::copy(registers_.begin(), registers_.end(), registers);
    for (const Instruction& instruction : instructions_) {
        if (instruction.result < 0) {
            add_closure(instruction.operation, instruction.variant, operands_of(instruction, registers), inputs,
                        result);
        } else {
            registers[instruction.result] = value_at(instruction, registers, inputs);
        }
    }
}

void Program::run_textured(const ShadingInputs& inputs, Vec4f* registers, Closures& result) const {
    const size_t count = registers_.size();
    Vec4f* const banks[kPlaces] = {registers, registers + count, registers + 2 * count};
    for (Vec4f* bank : banks) std::copy(registers_.begin(), registers_.end(), bank);
    const NeighbourAttributes attributes =
        differentiates_attributes_ ? NeighbourAttributes::Exact : NeighbourAttributes::None;
    const Neighbours neighbours(inputs, attributes);
    const ShadingInputs* const places[kPlaces] = {&inputs, &neighbours.right(), &neighbours.above()};
    for (const Instruction& instruction : instructions_) {
        if (instruction.result < 0) {
            add_closure(instruction.operation, instruction.variant, operands_of(instruction, registers), inputs,
                        result);
            continue;
        }
        const size_t runs = instruction.differentiated ? kPlaces : 1;
        if (operation_info(instruction.operation).family != OperationFamily::Texture) {
            for (size_t i = 0; i < runs; ++i)
                banks[i][instruction.result] = value_at(instruction, banks[i], *places[i]);
            continue;
        }
        // The neighbours of a lookup that another lookup depends on share its footprint.
        const Vec3f here = operands_of(instruction, banks[0]).vector(0);
        CoordinateFootprint coordinate{here, operands_of(instruction, banks[1]).vector(0) - here,
                                       operands_of(instruction, banks[2]).vector(0) - here};
        for (size_t i = 0; i < runs; ++i) {
            coordinate.value = operands_of(instruction, banks[i]).vector(0);
            banks[i][instruction.result] = image_value(instruction.operation, ints_of(instruction), coordinate, inputs);
        }
    }
}

template <typename Function>
void Program::with_registers(Function function) const {
    const size_t count = registers_.size() * (textured_ ? kPlaces : 1);
    if (count <= kStackRegisters) {
        Vec4f registers[kStackRegisters];
        function(registers);
    } else {
        static thread_local std::vector<Vec4f> registers;
        if (registers.size() < count) registers.resize(count);
        function(registers.data());
    }
}

void Program::evaluate(const ShadingInputs& inputs, Closures& result) const {
    result.clear();
    with_registers([&](Vec4f* registers) {
        textured_ ? run_textured(inputs, registers, result) : run(inputs, registers, result);
    });
    result.emission = finite_and_positive(result.emission);
    result.transparency = finite_and_positive(result.transparency);
    result.holdout = saturate(finite(result.holdout));
}

Vec4f Program::value(Register target, const ShadingInputs& inputs) const {
    RAYLEAF_ASSERT_GE(target, 0);
    RAYLEAF_ASSERT_LT(target, register_count());
    Closures ignored;
    Vec4f value;
    with_registers([&](Vec4f* registers) {
        textured_ ? run_textured(inputs, registers, ignored) : run(inputs, registers, ignored);
        value = registers[target];
    });
    return value;
}

}  // namespace rayleaf
