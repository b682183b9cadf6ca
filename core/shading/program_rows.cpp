// Running a program: frequent operations, each done for all points of a run in a loop of its own, from rows of numbers
// to rows of numbers. Each point gets the bits that Program::arithmetic has for it.
#include "shading/noise_lanes.h"
#include "shading/operands.h"
#include "shading/operations_color.h"
#include "shading/operations_math.h"
#include "shading/operations_pattern.h"
#include "shading/operations_texture.h"
#include "shading/program.h"

#include <algorithm>

namespace rayleaf {

/// The operands of an instruction, and its result, at all points.
class Program::Rows {
  public:
    Rows(const Program& program, const Instruction& instruction, const RegisterBank& registers)
        : registers_(registers),
          operands_(program.operands_.data() + instruction.first_operand, instruction.operand_count),
          result_(instruction.result) {}

    size_t count() const { return registers_.points; }
    bool is_constant(uint32_t operand) const { return index(operand) < 0 || index(operand) >= kFirstConstant; }
    NumberRow row(uint32_t operand, uint32_t component, const float& otherwise) const {
        return index(operand) >= 0 ? registers_.row(index(operand), component) : NumberRow{&otherwise, 0};
    }
    float* result(uint32_t component) const { return registers_.component(result_, component); }

  private:
    const RegisterBank& registers_;
    std::span<const Register> operands_;
    Register result_;

    Register index(uint32_t operand) const { return operand < operands_.size() ? operands_[operand] : -1; }
};

namespace {

constexpr float kZero = 0.0f;

/// A row without steps: a constant is repeated.
class DenseRow {
  public:
    explicit DenseRow(const NumberRow& row, size_t count) : first_(row.first) {
        if (row.step != 0) return;
        std::fill_n(room_, count, *row.first);
        first_ = room_;
    }
    DenseRow(const DenseRow&) = delete;
    DenseRow& operator=(const DenseRow&) = delete;
    operator const float*() const { return first_; }

  private:
    const float* first_;
    alignas(64) float room_[kMostPoints];
};

}  // namespace

bool Program::compute_noise(const Instruction& instruction, const RegisterBank& registers) const {
    const std::span<const int32_t> ints = ints_of(instruction);
    const bool is_plain_noise =  // Perlin's, its octaves scaled to 0..1
        (ints.size() < 2 || ints[1] != 0) && (ints.size() < 3 || static_cast<FractalType>(ints[2]) == FractalType::FBM);
    if (!is_plain_noise || registers.points < kLeastNoiseLanes) return false;
    const Rows rows(*this, instruction, registers);
    const auto row = [&](uint32_t i, uint32_t component, const float& otherwise) {
        return rows.row(i, component, otherwise);
    };
    constexpr float kLacunarity = 2.0f;
    NoiseLanes lanes;
    lanes.count = registers.points;
    lanes.set_points({row(0, 0, kZero), row(0, 1, kZero), row(0, 2, kZero), row(1, 0, kZero)}, row(2, 0, kZero));
    lanes.set_parameters(row(3, 0, kZero), row(4, 0, kZero), row(5, 0, kZero), row(6, 0, kLacunarity));
    const bool only_factor = static_cast<NoiseUse>(instruction.variant) == NoiseUse::Factor;
    noise_texture(ints[0], only_factor ? NoiseChannels::Factor : NoiseChannels::All, lanes);
    for (uint32_t i = 0; i < 4; ++i) {
        const float* channel = lanes.channels[only_factor || i == 3 ? 0 : i];
        std::copy_n(channel, registers.points, registers.component(instruction.result, i));
    }
    return true;
}

/// False where the mapping itself differs between points.
bool Program::compute_mapping(const Instruction& instruction, const RegisterBank& registers) const {
    const Rows rows(*this, instruction, registers);
    if (!rows.is_constant(1) || !rows.is_constant(2) || !rows.is_constant(3)) return false;
    const Operands operands = operands_of(instruction, registers, 0);
    const Mapping mapping{static_cast<MappingVariant>(instruction.variant), operands.vector(1),
                          EulerRotation(operands.vector(2)), operands.vector(3, Vec3f(1.0f))};
    const NumberRow x = rows.row(0, 0, kZero), y = rows.row(0, 1, kZero), z = rows.row(0, 2, kZero);
    for (uint32_t i = 0; i < rows.count(); ++i)
        registers.set(instruction.result, i, extended(mapping.of(Vec3f(x[i], y[i], z[i]))));
    return true;
}

/// False where the blend does not treat each channel alone.
bool Program::compute_mix(const Instruction& instruction, const RegisterBank& registers) const {
    const Rows rows(*this, instruction, registers);
    const std::span<const int32_t> ints = ints_of(instruction);
    const auto flag = [&](size_t i) { return i < ints.size() && ints[i] != 0; };
    const auto clamp = [&](float* row) {
        for (size_t i = 0; i < rows.count(); ++i) row[i] = saturate(row[i]);
    };
    const auto variant = static_cast<BlendVariant>(instruction.variant);
    for (uint32_t channel = 0; channel < 3; ++channel) {
        const NumberRow given = rows.row(0, channel, kZero);
        alignas(64) float factor[kMostPoints];
        for (size_t i = 0; i < rows.count(); ++i) factor[i] = given[i];
        if (flag(0)) clamp(factor);
        const DenseRow a(rows.row(1, channel, kZero), rows.count()), b(rows.row(2, channel, kZero), rows.count());
        if (!blend_rows(variant, rows.count(), factor, a, b, rows.result(channel))) return false;
        if (flag(1)) clamp(rows.result(channel));
    }
    std::fill_n(rows.result(3), rows.count(), 1.0f);
    return true;
}

void Program::compute_checker(const Instruction& instruction, const RegisterBank& registers) const {
    const Rows rows(*this, instruction, registers);
    const NumberRow x = rows.row(0, 0, kZero), y = rows.row(0, 1, kZero), z = rows.row(0, 2, kZero);
    const NumberRow scale = rows.row(3, 0, kZero);
    float* factor = rows.result(3);
    for (size_t i = 0; i < rows.count(); ++i)
        factor[i] = checker_value(
            {sound_coordinate(x[i] * scale[i]), sound_coordinate(y[i] * scale[i]), sound_coordinate(z[i] * scale[i])});
    for (uint32_t channel = 0; channel < 3; ++channel) {
        const DenseRow a(rows.row(1, channel, kZero), rows.count()), b(rows.row(2, channel, kZero), rows.count());
        for (size_t i = 0; i < rows.count(); ++i) rows.result(channel)[i] = factor[i] == 1.0f ? a[i] : b[i];
    }
}

void Program::compute_table(const Instruction& instruction, const RegisterBank& registers) const {
    const Rows rows(*this, instruction, registers);
    const std::span<const float> entries = floats_of(instruction);
    const NumberRow x = rows.row(0, 0, kZero);
    const bool linear = flag_of(instruction);
    for (uint32_t i = 0; i < rows.count(); ++i)
        registers.set(instruction.result, i, table_value(entries, x[i], linear));
}

void Program::compute_component(const Instruction& instruction, const RegisterBank& registers) const {
    const Rows rows(*this, instruction, registers);
    const NumberRow numbers = rows.row(0, static_cast<uint32_t>(ints_[instruction.first_int]), kZero);
    for (uint32_t channel = 0; channel < 4; ++channel)
        for (size_t i = 0; i < rows.count(); ++i) rows.result(channel)[i] = numbers[i];
}

/// False: this operation is done point by point.
bool Program::compute_together(const Instruction& instruction, const RegisterBank& registers) const {
    switch (instruction.operation) {
        case Operation::noise:
            return compute_noise(instruction, registers);
        case Operation::mapping:
            return compute_mapping(instruction, registers);
        case Operation::mix:
            return compute_mix(instruction, registers);
        case Operation::checker:
            compute_checker(instruction, registers);
            return true;
        case Operation::table:
            compute_table(instruction, registers);
            return true;
        case Operation::component:
            compute_component(instruction, registers);
            return true;
        default:
            return false;
    }
}

}  // namespace rayleaf
