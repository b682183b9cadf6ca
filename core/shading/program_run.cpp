// Running a program: the interpreter. Each operation is done for all points of the run before the next one.
#include "base/assert.h"
#include "shading/even_closures.h"
#include "shading/ies.h"
#include "shading/neighbour.h"
#include "shading/operands.h"
#include "shading/operations_closure.h"
#include "shading/operations_color.h"
#include "shading/operations_input.h"
#include "shading/operations_math.h"
#include "shading/operations_pattern.h"
#include "shading/operations_surroundings.h"
#include "shading/operations_texture.h"
#include "shading/program.h"
#include "shading/sky.h"
#include "shading/spectrum.h"

#include <array>
#include <cstddef>
#include <new>

namespace rayleaf {
namespace {

/// Runs of up to this many numbers keep them on the stack.
constexpr size_t kStackNumbers = 4096;
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

/// Whether images are looked up over an area; else at a point.
bool has_footprint(const ShadingInputs& inputs) {
    const RayDifferential& d = inputs.differential;
    return !(is_black(d.dp_dx) && is_black(d.dp_dy) && is_black(d.dd_dx) && is_black(d.dd_dy));
}

Color finite_and_positive(const Color& c) {
    return {std::max(finite_or_zero(c.x), 0.0f), std::max(finite_or_zero(c.y), 0.0f),
            std::max(finite_or_zero(c.z), 0.0f)};
}

}  // namespace

Operands Program::operands_of(const Instruction& instruction, const RegisterBank& registers, uint32_t point) const {
    return {registers, point, operands_.data() + instruction.first_operand, instruction.operand_count};
}

std::span<const int32_t> Program::ints_of(const Instruction& instruction) const {
    return {ints_.data() + instruction.first_int, instruction.int_count};
}

std::span<const float> Program::floats_of(const Instruction& instruction) const {
    return {floats_.data() + instruction.first_float, instruction.float_count};
}

bool Program::flag_of(const Instruction& instruction) const {
    return instruction.int_count > 0 && ints_[instruction.first_int] != 0;
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
            return extended(Mapping{static_cast<MappingVariant>(variant), operands.vector(1),
                                    EulerRotation(operands.vector(2)), operands.vector(3, Vec3f(1.0f))}
                                .of(operands.vector(0)));
        case Operation::vector_rotate:
            return extended(vector_rotate_value(static_cast<VectorRotateVariant>(variant), operands, flag(0)));
        case Operation::wavelength:
            return extended(wavelength_color(operands.scalar(0)));
        case Operation::blackbody:
            return extended(blackbody_color(operands.scalar(0)));
        case Operation::box_projection:
            return box_projection(operands.vector(0), operands.vector(1), operands.scalar(2), ints[0]);
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
        case Operation::ies:
            return spread(ies_value(floats_of(instruction), operands.vector(0)));
        case Operation::sky:
            return extended(sky_value(floats_of(instruction), operands.vector(0)));
        case Operation::table:
            return table_value(floats_of(instruction), operands.scalar(0), flag(0));
        default:
            return pattern_value(instruction.operation, variant, operands, ints);
    }
}

/// Of an operation of the family Input.
Vec4f Program::input_at(const Instruction& instruction, const Operands& operands, const ShadingInputs& inputs) const {
    if (is_probe(instruction.operation))
        return surroundings_value(instruction.operation, operands, ints_of(instruction), inputs,
                                  static_cast<uint32_t>(instruction.result));
    return input_value(instruction.operation, instruction.variant, operands, ints_of(instruction), inputs);
}

RegisterBank Program::bank(float* numbers, size_t points) const {
    return {numbers, static_cast<uint32_t>(points), registers_.data()};
}

void Program::compute(const Instruction& instruction, const RegisterBank& registers, Inputs inputs) const {
    if (compute_together(instruction, registers)) return;
    if (operation_info(instruction.operation).family == OperationFamily::Input) {
        for (uint32_t i = 0; i < registers.points; ++i)
            registers.set(instruction.result, i,
                          input_at(instruction, operands_of(instruction, registers, i), *inputs[i]));
    } else {
        for (uint32_t i = 0; i < registers.points; ++i)
            registers.set(instruction.result, i, arithmetic(instruction, operands_of(instruction, registers, i)));
    }
}

/// Without results, closures are not wanted.
void Program::add_closures(const Instruction& instruction, const RegisterBank& registers, Inputs inputs,
                           Results results) const {
    if (results.empty()) return;
    for (uint32_t i = 0; i < registers.points; ++i)
        add_closure(instruction.operation, instruction.variant, operands_of(instruction, registers, i),
                    ints_of(instruction), *inputs[i], *results[i]);
}

void Program::run(Inputs inputs, const RegisterBank& registers, Results results) const {
    for (const Instruction& instruction : instructions_) {
        if (instruction.result < 0)
            add_closures(instruction, registers, inputs, results);
        else
            compute(instruction, registers, inputs);
    }
}

/// `places` are the hit and its two neighbours, or the hit alone where no point has a footprint.
void Program::look_up(const Instruction& instruction, std::span<const RegisterBank> places, Inputs inputs) const {
    const auto at = [&](size_t place, uint32_t i) { return operands_of(instruction, places[place], i).vector(0); };
    // The neighbours of a lookup that another lookup depends on share its footprint.
    const size_t lookups = instruction.differentiated ? places.size() : 1;
    const float width = step_width();
    for (uint32_t i = 0; i < inputs.size(); ++i) {
        const Vec3f here = at(0, i);
        CoordinateFootprint coordinate{here, Vec3f(0.0f), Vec3f(0.0f)};
        if (has_footprint(*inputs[i])) {
            coordinate.dx = (at(1, i) - here) / width;
            coordinate.dy = (at(2, i) - here) / width;
        }
        for (size_t place = 0; place < lookups; ++place) {
            coordinate.value = at(place, i);
            places[place].set(instruction.result, i,
                              image_value(instruction.operation, ints_of(instruction), coordinate, *inputs[i]));
        }
    }
}

/// The hits with round footprints, by which bumps are: the steps of Cycles' (its compact differentials), which do not
/// grow where a surface is seen at grazing.
class Program::RoundFootprints {
  public:
    explicit RoundFootprints(Inputs inputs) : count_(inputs.size()) {
        for (size_t i = 0; i < count_; ++i) {
            auto* rounded = new (room_ + i * sizeof(ShadingInputs)) ShadingInputs(*inputs[i]);
            if (rounded->point)
                rounded->differential =
                    rounded->differential.round_footprint(rounded->outgoing, rounded->point->facet_normal);
            all_[i] = rounded;
        }
    }
    Inputs inputs() const { return {all_.data(), count_}; }

  private:
    static_assert(std::is_trivially_destructible_v<ShadingInputs>);
    size_t count_;
    std::array<const ShadingInputs*, kMostPoints> all_;
    alignas(ShadingInputs) std::byte room_[kMostPoints * sizeof(ShadingInputs)];
};

/// The hits' neighbours, made for the points there are.
class Program::Beside {
  public:
    Beside(Inputs inputs, NeighbourAttributes attributes, float width) : count_(inputs.size()) {
        static_assert(std::is_trivially_destructible_v<Neighbours>);
        for (size_t i = 0; i < count_; ++i) {
            const auto* neighbours = new (room_ + i * sizeof(Neighbours)) Neighbours(*inputs[i], attributes, width);
            right_[i] = &neighbours->right();
            above_[i] = &neighbours->above();
        }
    }
    Inputs right() const { return {right_.data(), count_}; }
    Inputs above() const { return {above_.data(), count_}; }

  private:
    size_t count_;
    std::array<const ShadingInputs*, kMostPoints> right_, above_;
    alignas(Neighbours) std::byte room_[kMostPoints * sizeof(Neighbours)];
};

/// A bumped normal, by heights at the neighbours. Where it is differentiated itself, it is the same there.
void Program::bend(const Instruction& instruction, std::span<const RegisterBank> places, Inputs inputs) const {
    for (uint32_t point = 0; point < inputs.size(); ++point) {
        const auto height = [&](size_t place) {
            return operands_of(instruction, places[std::min(place, places.size() - 1)], point).scalar(0);
        };
        const float here = height(0);
        const auto at_a_pixel = [&](size_t place) { return here + (height(place) - here) / bump_width_; };
        const Vec4f normal = bump_value(operands_of(instruction, places[0], point), flag_of(instruction),
                                        {here, at_a_pixel(1), at_a_pixel(2)}, *inputs[point], clearing_);
        for (size_t place = 0; place < (instruction.differentiated ? places.size() : 1); ++place)
            places[place].set(instruction.result, point, normal);
    }
}

/// What is around changes little from a hit to its neighbours, which have it too.
void Program::probe(const Instruction& instruction, std::span<const RegisterBank> places, Inputs inputs) const {
    for (uint32_t point = 0; point < inputs.size(); ++point) {
        const Vec4f value = input_at(instruction, operands_of(instruction, places[0], point), *inputs[point]);
        for (size_t place = 0; place < (instruction.differentiated ? places.size() : 1); ++place)
            places[place].set(instruction.result, point, value);
    }
}

void Program::run_textured(Inputs inputs, std::span<const RegisterBank> places, Results results) const {
    const NeighbourAttributes attributes = differentiates_attributes_  ? NeighbourAttributes::Exact
                                           : differentiates_generated_ ? NeighbourAttributes::ExactIfDeformed
                                                                       : NeighbourAttributes::None;
    const Beside beside(places.size() > 1 ? inputs : Inputs(), attributes, step_width());
    const std::array<Inputs, kPlaces> inputs_of = {inputs, beside.right(), beside.above()};
    for (const Instruction& instruction : instructions_) {
        if (instruction.result < 0) {
            add_closures(instruction, places[0], inputs, results);
        } else if (operation_info(instruction.operation).family == OperationFamily::Texture) {
            look_up(instruction, places, inputs);
        } else if (instruction.operation == Operation::bump) {
            bend(instruction, places, inputs);
        } else if (is_probe(instruction.operation)) {
            probe(instruction, places, inputs);
        } else {
            const size_t runs = instruction.differentiated ? places.size() : 1;
            for (size_t place = 0; place < runs; ++place) compute(instruction, places[place], inputs_of[place]);
        }
    }
}

template <typename Function>
void Program::with_registers(size_t points, Function function) const {
    const size_t count = registers_.size() * 4 * points * (textured_ ? kPlaces : 1);
    if (count <= kStackNumbers) {
        alignas(64) float numbers[kStackNumbers];
        function(numbers);
    } else {
        static thread_local std::vector<float> numbers;
        if (numbers.size() < count) numbers.resize(count);
        function(numbers.data());
    }
}

void Program::execute(Inputs inputs, float* numbers, Results results) const {
    if (!textured_) return run(inputs, bank(numbers, inputs.size()), results);
    std::array<RegisterBank, kPlaces> places;
    for (size_t i = 0; i < kPlaces; ++i)
        places[i] = bank(numbers + i * registers_.size() * 4 * inputs.size(), inputs.size());
    const bool any = std::any_of(inputs.begin(), inputs.end(), [](const auto* each) { return has_footprint(*each); });
    if (!bends_ || !any) return run_textured(inputs, {places.data(), any ? kPlaces : 1}, results);
    const RoundFootprints rounded(inputs);
    run_textured(rounded.inputs(), places, results);
}

void Program::find_even_closures() {
    even_closures_ = nullptr;
    if (reads_inputs_ || !closures_turn_alone_) return;
    even_closures_ = std::make_shared<const EvenClosures>(
        [this](const ShadingInputs& inputs, Closures& result) { evaluate(inputs, result); });
}

std::optional<Color> Program::even_emission() const {
    if (even_closures_) return even_closures_->even_emission();
    if (!is_constant()) return std::nullopt;
    Closures closures;
    evaluate(ShadingInputs{}, closures);
    return closures.emission;
}

/// False where the program must run.
bool Program::copy_even_closures(Inputs inputs, Results results) const {
    if (!even_closures_ || inputs.empty() || inputs[0]->point == nullptr) return false;
    for (size_t i = 0; i < inputs.size(); ++i)
        if (!even_closures_->copy(*inputs[i], *results[i])) return false;
    return true;
}

void Program::evaluate(std::span<const ShadingInputs* const> inputs, std::span<Closures* const> results) const {
    RAYLEAF_ASSERT_LE(inputs.size(), kMostPoints);
    if (copy_even_closures(inputs, results)) return;
    for (size_t i = 0; i < results.size(); ++i) {
        results[i]->clear();
        results[i]->smooth_normal = inputs[i]->point ? facing_normal(*inputs[i]) : Vec3f(0.0f);
        results[i]->bump_shadow = bump_shadow_;
        results[i]->clearing = clearing_;
    }
    with_registers(inputs.size(), [&](float* numbers) { execute(inputs, numbers, results); });
    for (Closures* result : results) {
        result->emission = finite_and_positive(result->emission);
        result->transparency = finite_and_positive(result->transparency);
        result->holdout = saturate(finite_or_zero(result->holdout));
    }
}

void Program::evaluate(const ShadingInputs& inputs, Closures& result) const {
    Closures* const results[] = {&result};
    const ShadingInputs* const points[] = {&inputs};
    evaluate(points, results);
}

void Program::values(Register target, std::span<const ShadingInputs* const> inputs, Vec4f* values) const {
    RAYLEAF_ASSERT_GE(target, 0);
    RAYLEAF_ASSERT_LT(target, register_count());
    RAYLEAF_ASSERT_LE(inputs.size(), kMostPoints);
    with_registers(inputs.size(), [&](float* numbers) {
        execute(inputs, numbers, {});
        const RegisterBank registers = bank(numbers, inputs.size());
        const Register index = is_constant_register(target) ? kFirstConstant + target : target;
        for (uint32_t i = 0; i < registers.points; ++i) values[i] = registers.value(index, i);
    });
}

Vec4f Program::value(Register target, const ShadingInputs& inputs) const {
    const ShadingInputs* const points[] = {&inputs};
    Vec4f value(0.0f);
    values(target, points, &value);
    return value;
}

}  // namespace rayleaf
