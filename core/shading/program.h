// The flat shader program that Blender's node trees compile to: a list of operations over registers, run once per hit.
#pragma once

#include "base/vector.h"
#include "shading/closures.h"
#include "shading/inputs.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace rayleaf {

enum class Operation : uint8_t {
#define OPERATION(identifier, least, most, description) identifier,
#include "shading/operations.def"
#undef OPERATION
};

using Register = int32_t;  ///< -1: not connected

/// A program under construction. Every mistake throws InputError that names the material.
/// After the last operation `finish` is called; the program is then immutable and read by all threads.
class Program {
  public:
    explicit Program(std::string name) : name_(std::move(name)) {}

    /// A register that holds a constant.
    Register constant(const Vec4f& value);
    /// Appends an operation of the table; returns its result register, -1 for closures.
    Register operation(const std::string& identifier, std::span<const Register> operands,
                       std::span<const int32_t> ints = {}, std::span<const float> floats = {},
                       const std::string& text = {});

    const std::string& name() const { return name_; }

    /// Runs the program: closures, emission and transparency of one point. Pure; never NaN.
    void evaluate(const ShadingInputs& inputs, Closures& result) const;

    /// What the program may do, so that a scene pays only for what it uses.
    bool emits() const { return emits_; }
    bool may_be_transparent() const { return transparent_; }
    /// True if the result does not depend on the hit: a constant background, a plain lamp colour.
    bool is_constant() const { return constant_; }

  private:
    struct Instruction {
        Operation operation;
        uint8_t variant = 0;  ///< what `text` named, as an enum of the operation
        Register result = -1;
        uint32_t first_operand = 0, first_int = 0, first_float = 0;
        uint32_t operand_count = 0, int_count = 0, float_count = 0;
    };

    std::string name_;
    std::vector<Instruction> instructions_;
    std::vector<Register> operands_;
    std::vector<int32_t> ints_;
    std::vector<float> floats_;
    std::vector<Vec4f> constants_;  ///< initial contents of the registers
    bool emits_ = false, transparent_ = false, constant_ = true;
};

}  // namespace rayleaf
