#include "shading/program.h"

#include "base/error.h"
#include "shading/even_closures.h"
#include "shading/ies.h"
#include "shading/operations_hair.h"
#include "shading/operations_surroundings.h"
#include "shading/variants.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace rayleaf {
namespace {

std::string joined(std::span<const std::string_view> names) {
    std::string text;
    for (const std::string_view name : names) text.append(text.empty() ? "" : ", ").append(name);
    return text;
}

std::string between(int least, int most) {
    if (least == most) return std::to_string(least);
    return std::to_string(least) + " to " + std::to_string(most);
}

/// What is the same for all points that an instance or a ray has.
bool is_even_in_space(Operation operation) {
    switch (operation) {
        case Operation::light_path:
        case Operation::object_location:
        case Operation::object_index:
        case Operation::object_random:
        case Operation::material_index:
            return true;
        default:
            return false;
    }
}

bool is_finite_color(const Vec4f& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) && std::isfinite(v.w);
}

/// Limits of an operation's integers; most < least: any.
struct IntRange {
    int least = 0, most = -1;
};

IntRange int_range(Operation operation, size_t i) {
    switch (operation) {
        case Operation::component:
            return {0, 3};
        case Operation::noise:
            return i == 0 ? IntRange{1, 4} : IntRange{0, i == 1 ? 1 : 4};
        case Operation::voronoi:
            return i == 0 ? IntRange{1, 4} : IntRange{0, i == 1 ? 3 : 1};
        case Operation::musgrave:
        case Operation::white_noise:
            return {1, 4};
        case Operation::wave:
            return {0, i == 0 ? 1 : 3};
        case Operation::magic:
            return {0, 10};
        case Operation::gabor:
            return {2, 3};
        case Operation::transform:
        case Operation::radial_tangent:
        case Operation::box_projection:
            return {0, 2};
        case Operation::brick:
            return {0, 99};
        case Operation::ambient_occlusion:
        case Operation::bevel:
            return i == 0 ? IntRange{1, 1024} : IntRange{0, 1};
        case Operation::raycast:
            return {0, 1};
        case Operation::subsurface:
        case Operation::principled:
        case Operation::principled_layers:
            return {0, i == 0 ? 3 : 1};
        case Operation::diffuse:
        case Operation::toon:
        case Operation::glossy:
        case Operation::refraction:
        case Operation::glass:
        case Operation::metal:
        case Operation::table:
        case Operation::math:
        case Operation::mix:
        case Operation::map_range:
        case Operation::vector_rotate:
        case Operation::wireframe:
        case Operation::bump:
            return {0, 1};
        case Operation::image:
            return i == 0 || i > 3 ? IntRange{} : IntRange{0, i == 1 ? 3 : i == 2 ? 6 : 2};
        case Operation::environment:
            return i == 0 ? IntRange{} : IntRange{0, i == 1 ? 1 : 6};
        default:
            return {};
    }
}

}  // namespace

void Program::reject(const std::string& argument, const std::string& got, const std::string& wanted) const {
    throw InputError(name_, argument, got, wanted);
}

Register Program::constant(const Vec4f& value) {
    if (!is_finite_color(value)) reject("shader constant", "not finite", "four finite numbers");
    registers_.push_back(value);
    origins_.push_back(kConstant);
    return static_cast<Register>(registers_.size()) - 1;
}

Program::Instruction Program::checked(const std::string& identifier, std::span<const Register> operands,
                                      std::span<const int32_t> ints, std::span<const float> floats,
                                      const std::string& text) const {
    const std::optional<Operation> operation = operation_named(identifier);
    if (!operation) reject("shader operation", "'" + identifier + "'", "one of the table of operations");
    const OperationInfo& info = operation_info(*operation);
    const auto in = [&](int least, int most, size_t count) {
        return static_cast<int>(count) >= least && static_cast<int>(count) <= most;
    };
    if (!in(info.least_operands, info.most_operands, operands.size()))
        reject("number of operands of '" + identifier + "'", std::to_string(operands.size()),
               between(info.least_operands, info.most_operands));
    for (const Register r : operands)
        if (r < -1 || r >= register_count())
            reject("operand of '" + identifier + "'", std::to_string(r),
                   "-1 or an earlier register (below " + std::to_string(register_count()) + ")");
    if (!in(info.least_ints, info.most_ints, ints.size()))
        reject("number of integers of '" + identifier + "'", std::to_string(ints.size()),
               between(info.least_ints, info.most_ints));
    for (size_t i = 0; i < ints.size(); ++i)
        if (const IntRange range = int_range(*operation, i);
            range.least <= range.most && (ints[i] < range.least || ints[i] > range.most))
            reject("integer of '" + identifier + "'", std::to_string(ints[i]), between(range.least, range.most));
    if (info.takes_floats ? floats.empty() || floats.size() % 4 != 0 : !floats.empty())
        reject("number of floats of '" + identifier + "'", std::to_string(floats.size()),
               info.takes_floats ? "a positive multiple of 4" : "0");
    if (!std::all_of(floats.begin(), floats.end(), [](float x) { return std::isfinite(x); }))
        reject("table of '" + identifier + "'", "not finite", "finite numbers");
    if (*operation == Operation::ies && !is_ies_table(floats))
        reject("table of 'ies'", "no table of intensities over angles", "one as shading/ies.h has it");
    if (*operation == Operation::sky && !is_sky_table(floats))
        reject("table of 'sky'", "no table of a sky", "one as shading/sky.h has it");

    Instruction instruction{};
    instruction.operation = *operation;
    const std::span<const std::string_view> variants = variants_of(*operation);
    const bool optional_text = *operation == Operation::principled || *operation == Operation::principled_layers ||
                               *operation == Operation::volume_scatter;
    if (variants.empty() ? !text.empty() : !(optional_text && text.empty())) {
        const auto found = std::find(variants.begin(), variants.end(), text);
        if (found == variants.end())
            reject("text of '" + identifier + "'", "'" + text + "'", variants.empty() ? "empty" : joined(variants));
        instruction.variant = static_cast<uint8_t>(found - variants.begin());
    }
    return instruction;
}

Register Program::operation(const std::string& identifier, std::span<const Register> operands,
                            std::span<const int32_t> ints, std::span<const float> floats, const std::string& text) {
    Instruction instruction = checked(identifier, operands, ints, floats, text);
    const OperationFamily family = operation_info(instruction.operation).family;
    instruction.first_operand = static_cast<uint32_t>(operands_.size());
    instruction.first_int = static_cast<uint32_t>(ints_.size());
    instruction.first_float = static_cast<uint32_t>(floats_.size());
    instruction.operand_count = static_cast<uint32_t>(operands.size());
    instruction.int_count = static_cast<uint32_t>(ints.size());
    instruction.float_count = static_cast<uint32_t>(floats.size());
    for (const Register r : operands) operands_.push_back(r >= 0 && is_constant_register(r) ? kFirstConstant + r : r);
    ints_.insert(ints_.end(), ints.begin(), ints.end());
    floats_.insert(floats_.end(), floats.begin(), floats.end());

    if (family == OperationFamily::Arithmetic &&
        std::all_of(operands.begin(), operands.end(), [this](Register r) { return is_constant_register(r); })) {
        const Vec4f value =
            arithmetic(instruction, operands_of(instruction, RegisterBank{nullptr, 1, registers_.data()}, 0));
        operands_.resize(instruction.first_operand);
        ints_.resize(instruction.first_int);
        floats_.resize(instruction.first_float);
        return constant(is_finite_color(value) ? value : spread(0.0f));
    }
    if (family != OperationFamily::Closure) {
        instruction.result = register_count();
        registers_.emplace_back(0.0f, 0.0f, 0.0f, 0.0f);
        origins_.push_back(static_cast<int32_t>(instructions_.size()));
    }
    note_effects(instruction, operands);
    note_noise_use(instruction, operands);
    instructions_.push_back(instruction);
    if (family == OperationFamily::Closure)
        closures_turn_alone_ &= turns_alone(instruction.operation, instruction.variant,
                                            operands_of(instruction, RegisterBank{nullptr, 1, registers_.data()}, 0));
    find_even_closures();
    return instruction.result;
}

void Program::note_effects(const Instruction& instruction, std::span<const Register> operands) {
    const auto surely = [&](size_t i, float x) {
        if (i >= operands.size() || operands[i] < 0 || !is_constant_register(operands[i])) return false;
        const Vec4f& v = registers_[static_cast<size_t>(operands[i])];
        return v.x == x && v.y == x && v.z == x;
    };
    const OperationFamily family = operation_info(instruction.operation).family;
    if (family == OperationFamily::Texture) {
        textured_ = true;
        if (operands[0] >= 0) differentiate(operands[0]);
    }
    reads_pixels_ |= instruction.operation == Operation::wireframe;
    asks_surroundings_ |= is_probe(instruction.operation);
    if (instruction.operation == Operation::bump) {
        textured_ = bends_ = true;
        if (operands[0] >= 0) differentiate(operands[0]);
    }
    const bool reads = family == OperationFamily::Input || family == OperationFamily::Texture;
    varies_in_space_ |= reads && !is_even_in_space(instruction.operation);
    if (reads) constant_ = false;
    reads_inputs_ |= reads;
    switch (instruction.operation) {
        case Operation::uv:
            (is_named_uv(instruction) ? reads_element_ : reads_uv_) = true;
            break;
        case Operation::generated:
            reads_generated_ = true;
            break;
        case Operation::attribute:
        case Operation::tangent:
        case Operation::radial_tangent:
        case Operation::wireframe:
        case Operation::ambient_occlusion:
        case Operation::bevel:
        case Operation::raycast:
        case Operation::bump:
        case Operation::from_tangent_space:
        case Operation::parametric:
        case Operation::normal_map:
            reads_element_ = true;
            break;
        case Operation::glossy:
            reads_element_ |=
                operands.size() > 4 && operands[4] >= 0 && !surely(4, 0.0f) && (operands.size() < 7 || operands[6] < 0);
            break;
        case Operation::metal:
            reads_element_ |=
                operands.size() > 5 && operands[5] >= 0 && !surely(5, 0.0f) && (operands.size() < 8 || operands[7] < 0);
            break;
        case Operation::hair:
            reads_element_ |= operands.size() < 6 || operands[5] < 0;
            break;
        case Operation::hair_fibre:
        case Operation::hair_facets:
            reads_element_ = true;
            break;
        case Operation::principled:
            reads_element_ |= operands[20] < 0 && !surely(6, 0.0f);  // anisotropy along the surface's own u
            break;
        case Operation::principled_layers:
            reads_element_ |= operands[22] < 0 && !surely(6, 0.0f);
            break;
        default:
            break;
    }
    if (family != OperationFamily::Closure) return;
    switch (instruction.operation) {
        case Operation::emission:
        case Operation::background:
            emits_ |= !surely(0, 0.0f) && !surely(1, 0.0f) && !surely(2, 0.0f);
            return;
        case Operation::transparent:
            transparent_ |= !surely(0, 0.0f) && !surely(1, 0.0f);
            return;
        case Operation::ray_portal:
            transparent_ |= !surely(0, 0.0f) && !surely(1, 0.0f);
            break;
        case Operation::hair_facets:  // beside a cross section that is not round
            transparent_ |= !surely(0, 0.0f) && !surely(kRatioOfHairAxes, 1.0f);
            return;
        case Operation::holdout:
            return;
        case Operation::principled:
        case Operation::principled_layers:
            emits_ |= !surely(15, 0.0f) && !surely(16, 0.0f);
            transparent_ |= operands[17] >= 0 && !surely(17, 1.0f);
            transparent_ |= operands.size() > 30 && operands[30] >= 0 && !surely(30, 0.0f) && !surely(19, 0.0f);
            break;
        case Operation::volume_scatter:
            scatters_ |= !surely(0, 0.0f) && !surely(1, 0.0f) && !surely(2, 0.0f);
            break;
        case Operation::volume_principled:
            scatters_ |= !surely(0, 0.0f) && !surely(1, 0.0f) && !surely(2, 0.0f);
            emits_ |= (!surely(5, 0.0f) && !surely(6, 0.0f)) || !surely(7, 0.0f);
            break;
        default:
            break;
    }
    constant_ = false;
}

/// A noise of which only the factor, the fourth component, is read need not compute its colour.
void Program::note_noise_use(const Instruction& reader, std::span<const Register> operands) {
    const bool reads_factor = reader.operation == Operation::component && ints_[reader.first_int] == 3;
    for (const Register r : operands) {
        if (is_constant_register(r)) continue;
        Instruction& source = instructions_[static_cast<size_t>(origins_[static_cast<size_t>(r)])];
        if (source.operation != Operation::noise) continue;
        const bool only_factor = reads_factor && source.variant != static_cast<uint8_t>(NoiseUse::All);
        source.variant = static_cast<uint8_t>(only_factor ? NoiseUse::Factor : NoiseUse::All);
    }
}

/// Whether it reads texture coordinates by the id of an attribute.
bool Program::is_named_uv(const Instruction& instruction) const {
    return instruction.operation == Operation::uv && instruction.int_count > 0 && ints_[instruction.first_int] >= 0;
}

/// Marks what `target` depends on to be run at the neighbouring points too.
void Program::differentiate(Register target) {
    std::vector<Register> open{target};
    while (!open.empty()) {
        const Register r = open.back();
        open.pop_back();
        if (r >= kFirstConstant || is_constant_register(r)) continue;
        Instruction& instruction = instructions_[static_cast<size_t>(origins_[static_cast<size_t>(r)])];
        if (instruction.differentiated) continue;
        instruction.differentiated = true;
        differentiates_attributes_ |= instruction.operation == Operation::attribute || is_named_uv(instruction);
        differentiates_generated_ |= instruction.operation == Operation::generated;
        const auto first = operands_.begin() + instruction.first_operand;
        open.insert(open.end(), first, first + instruction.operand_count);
    }
}

void Program::set_bump_width(float width) {
    if (!(width > 0.0f) || !std::isfinite(width)) reject("bump_width", std::to_string(width), "a positive number");
    bump_width_ = width;
}

void Program::add_to(ContentHasher& hasher) const {
    hasher.add(static_cast<int>(bump_shadow_));
    hasher.add(static_cast<int>(clearing_));
    hasher.add(bump_width_);
    for (const Instruction& instruction : instructions_) {
        hasher.add(static_cast<int>(instruction.operation));
        hasher.add(int{instruction.variant});
        hasher.add(instruction.result);
        for (const uint32_t count : {instruction.operand_count, instruction.int_count, instruction.float_count})
            hasher.add(count);
    }
    hasher.add(operands_);
    hasher.add(ints_);
    hasher.add(floats_);
    hasher.add(registers_);
}

std::vector<int32_t> Program::attributes() const {
    std::vector<int32_t> found;
    for (const Instruction& instruction : instructions_) {
        const bool names =
            instruction.operation == Operation::attribute || instruction.operation == Operation::grid_value;
        const int32_t id = names ? ints_[instruction.first_int] : -1;
        if (id >= 0 && std::find(found.begin(), found.end(), id) == found.end()) found.push_back(id);
    }
    return found;
}

bool Program::reads_camera() const {
    return std::any_of(instructions_.begin(), instructions_.end(), [](const Instruction& instruction) {
        return instruction.operation == Operation::camera_coordinates || instruction.operation == Operation::window ||
               instruction.operation == Operation::transform;
    });
}

}  // namespace rayleaf
