// How fine the detail of a world can be: as that of its pictures, where nothing else differs between directions. And
// where its suns are.
#include "shading/operands.h"
#include "shading/program.h"
#include "shading/variants.h"

#include <algorithm>

namespace rayleaf {
namespace {

/// How a register differs between directions.
enum class Detail : uint8_t {
    None,       ///< not at all
    Direction,  ///< it is the direction, turned or scaled evenly
    Picture,    ///< it comes of pictures around
    Any
};

/// Of two operands of one operation.
Detail both(Detail a, Detail b) {
    if (a == Detail::None || a == b) return b;
    return b == Detail::None ? a : Detail::Any;
}

bool is_direction_of_world(Operation operation) {
    switch (operation) {
        case Operation::generated:
        case Operation::object_coordinates:
        case Operation::position:
        case Operation::normal:
        case Operation::object_normal:
        case Operation::incoming:
            return true;
        default:
            return false;
    }
}

/// What these make of colours has no finer detail than they have.
bool keeps_detail(Operation operation) {
    switch (operation) {
        case Operation::mix:
        case Operation::component:
        case Operation::combine:
        case Operation::luminance:
        case Operation::average:
        case Operation::rgb_to_hsv:
        case Operation::hsv_to_rgb:
        case Operation::gamma:
        case Operation::invert:
        case Operation::bright_contrast:
        case Operation::hue_saturation:
            return true;
        default:
            return operation_info(operation).family == OperationFamily::Closure;
    }
}

}  // namespace

/// Whether a mapping, at most, turns directions: else parts of a picture may look smaller than it shows them.
bool Program::is_turn(const Instruction& mapping) const {
    const auto number = [&](uint32_t i, const Vec4f& otherwise) {
        const Register operand = operands_[mapping.first_operand + i];
        if (operand < 0) return std::optional(otherwise);
        const bool is_known = operand >= kFirstConstant;
        return is_known ? std::optional(registers_[static_cast<size_t>(operand - kFirstConstant)]) : std::nullopt;
    };
    const auto location = number(1, Vec4f(0.0f)), rotation = number(2, Vec4f(0.0f)), scale = number(3, Vec4f(1.0f));
    if (!location || !rotation || !scale) return false;
    const bool is_even = scale->x == scale->y && scale->y == scale->z && scale->x != 0.0f;
    return is_even && location->x == 0.0f && location->y == 0.0f && location->z == 0.0f;
}

std::vector<int32_t> Program::sole_environments() const {
    std::vector<Detail> details(registers_.size(), Detail::None);
    const auto of_operands = [&](const Instruction& instruction) {
        Detail all = Detail::None;
        for (uint32_t i = 0; i < instruction.operand_count; ++i) {
            const Register operand = operands_[instruction.first_operand + i];
            if (operand >= 0 && operand < kFirstConstant) all = both(all, details[static_cast<size_t>(operand)]);
        }
        return all;
    };
    const auto of_result = [&](const Instruction& instruction, Detail operands) {
        const Operation operation = instruction.operation;
        const bool reads_inputs = operation_info(operation).family == OperationFamily::Input;
        if (is_direction_of_world(operation)) return Detail::Direction;
        if (reads_inputs && operation != Operation::light_path) return Detail::Any;
        if (operands == Detail::None) return Detail::None;
        if (operands == Detail::Picture) return keeps_detail(operation) ? Detail::Picture : Detail::Any;
        if (operands == Detail::Any) return Detail::Any;
        const std::span<const int32_t> ints = ints_of(instruction);
        const bool is_equirectangular = ints.size() < 2 || ints[1] == 0;
        if (operation == Operation::environment && is_equirectangular) return Detail::Picture;
        return operation == Operation::mapping && is_turn(instruction) ? Detail::Direction : Detail::Any;
    };
    std::vector<int32_t> environments;
    for (const Instruction& instruction : instructions_) {
        const Detail detail = of_result(instruction, of_operands(instruction));
        if (instruction.operation == Operation::environment) environments.push_back(ints_of(instruction)[0]);
        if (instruction.result >= 0)
            details[static_cast<size_t>(instruction.result)] = detail;
        else if (detail == Detail::Any)
            return {};
    }
    return environments;
}

std::vector<SunDisc> Program::suns() const {
    const auto is_direction = [&](Register r) {
        const int32_t origin = r >= 0 && r < kFirstConstant ? origins_[static_cast<size_t>(r)] : kConstant;
        return origin != kConstant && instructions_[static_cast<size_t>(origin)].operation == Operation::generated;
    };
    std::vector<SunDisc> found;
    for (const Instruction& instruction : instructions_) {
        if (instruction.operation != Operation::sky || !is_direction(operands_[instruction.first_operand])) continue;
        if (const std::optional<SunDisc> sun = sun_of_sky(floats_of(instruction))) found.push_back(*sun);
    }
    return found;
}

}  // namespace rayleaf
