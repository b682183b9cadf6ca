// The flat shader program that Blender's node trees compile to: a list of operations over registers, run once per hit.
//
// Operations whose operands are all constant are computed when they are added. Image lookups need to know how their
// coordinate changes over the pixel: the operations it depends on, and only those, run a second and third time at the
// points one pixel step away by the ray's differential. That is exact to first order whatever the nodes between do.
#pragma once

#include "base/content_hash.h"
#include "base/vector.h"
#include "shading/closures.h"
#include "shading/inputs.h"
#include "shading/operation.h"
#include "shading/sky.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace rayleaf {

class Operands;
struct EvenClosures;
struct RegisterBank;

using Register = int32_t;  ///< -1: not connected

/// The most points that a program runs for at once: enough that finding out what to do costs little beside doing it,
/// and few enough that their registers stay in a core's own cache.
inline constexpr size_t kMostPoints = 32;

/// A program under construction. Every mistake throws InputError that names the material.
/// Once built it is only read, by all threads.
class Program {
  public:
    /// `bump_shadow`, `clearing`: of its closures.
    explicit Program(std::string name, BumpShadow bump_shadow = BumpShadow::Cubic, Clearing clearing = Clearing::All)
        : name_(std::move(name)), bump_shadow_(bump_shadow), clearing_(clearing) {}

    /// A register that holds a constant; its numbers must be finite.
    Register constant(const Vec4f& value);
    /// Appends an operation of the table; returns its result register, -1 for closures.
    Register operation(const std::string& identifier, std::span<const Register> operands,
                       std::span<const int32_t> ints = {}, std::span<const float> floats = {},
                       const std::string& text = {});

    const std::string& name() const { return name_; }
    /// The distance over which bumps compare heights, in pixels; positive. Below 1 they show heights that vary within a
    /// pixel.
    float bump_width() const { return bump_width_; }
    void set_bump_width(float width);
    /// All that its results depend on beside the inputs; textures by their numbers.
    void add_to(ContentHasher& hasher) const;

    /// Runs the program: closures, emission and transparency of one point, in place of what `result` held. Pure; never
    /// NaN.
    void evaluate(const ShadingInputs& inputs, Closures& result) const;
    /// The same for up to kMostPoints points at once: the same bits, in less time.
    void evaluate(std::span<const ShadingInputs* const> inputs, std::span<Closures* const> results) const;

    /// What a register holds after a run: for tests, and for programs that serve as functions. A closure's register
    /// (-1) is not allowed.
    Vec4f value(Register target, const ShadingInputs& inputs) const;
    /// The same for several points that run together.
    void values(Register target, std::span<const ShadingInputs* const> inputs, Vec4f* values) const;
    int register_count() const { return static_cast<int>(registers_.size()); }

    /// What the program may do: a scene spends time only on what it uses.
    bool emits() const { return emits_; }
    /// As a medium.
    bool scatters() const { return scatters_; }
    bool may_be_transparent() const { return transparent_; }
    /// True if the result does not depend on the hit: a constant background, a plain lamp colour.
    bool is_constant() const { return constant_; }
    /// What it emits at all points and in all directions; empty where that depends on them.
    std::optional<Color> even_emission() const;
    /// True if its closures are the same on all of a surface: nothing is read but the normal and the view.
    bool has_even_closures() const { return !reads_inputs_; }
    /// True if its closures may differ from place to place inside an object, beside those of its surface.
    bool varies_in_space() const { return varies_in_space_; }
    /// The named attributes that it reads, as such.
    std::vector<int32_t> attributes() const;
    /// True if it reads the active texture coordinate, as such.
    bool reads_uv() const { return reads_uv_; }
    /// True if it reads where the camera is.
    bool reads_camera() const;
    /// True if it looks up images, bends normals by heights, or reads the width of pixels.
    bool reads_footprint() const { return textured_ || reads_pixels_; }
    /// True if it reads what only an element of the shape knows, or its direction of u: attributes, named texture
    /// coordinates, tangents.
    bool reads_element() const { return reads_element_; }
    /// True if it reads places in the object's texture space, which an element knows of shapes that were deformed.
    bool reads_generated() const { return reads_generated_; }
    /// Of a world's program: the textures that it shows around, where nothing in it can have finer detail than they
    /// have. Else empty.
    std::vector<int32_t> sole_environments() const;
    /// Of a world's program: the suns of its skies that lie where these show them.
    std::vector<SunDisc> suns() const;
    /// Whether it asks what is around (ShadingInputs::surroundings).
    bool asks_surroundings() const { return asks_surroundings_; }

  private:
    struct Instruction {
        Operation operation;
        uint8_t variant = 0;          ///< what `text` named, as an enum of the operation
        bool differentiated = false;  ///< also run at the neighbouring points
        Register result = -1;
        uint32_t first_operand = 0, first_int = 0, first_float = 0;
        uint32_t operand_count = 0, int_count = 0, float_count = 0;
    };
    static constexpr int32_t kConstant = -1;  ///< origin of registers that no instruction writes

    Instruction checked(const std::string& identifier, std::span<const Register> operands,
                        std::span<const int32_t> ints, std::span<const float> floats, const std::string& text) const;
    void note_effects(const Instruction& instruction, std::span<const Register> operands);
    void note_noise_use(const Instruction& reader, std::span<const Register> operands);
    bool is_named_uv(const Instruction& instruction) const;
    bool is_turn(const Instruction& mapping) const;
    void differentiate(Register target);
    bool is_constant_register(Register r) const { return r < 0 || origins_[static_cast<size_t>(r)] == kConstant; }
    [[noreturn]] void reject(const std::string& argument, const std::string& got, const std::string& wanted) const;

    using Inputs = std::span<const ShadingInputs* const>;
    using Results = std::span<Closures* const>;
    class Beside;
    class RoundFootprints;

    Operands operands_of(const Instruction& instruction, const RegisterBank& registers, uint32_t point) const;
    std::span<const int32_t> ints_of(const Instruction& instruction) const;
    std::span<const float> floats_of(const Instruction& instruction) const;
    bool flag_of(const Instruction& instruction) const;  ///< its first integer
    /// The distance of a hit's neighbours from it, in pixels.
    float step_width() const { return bends_ ? bump_width_ : 1.0f; }
    Vec4f arithmetic(const Instruction& instruction, const Operands& operands) const;
    Vec4f input_at(const Instruction& instruction, const Operands& operands, const ShadingInputs& inputs) const;
    RegisterBank bank(float* numbers, size_t points) const;
    void compute(const Instruction& instruction, const RegisterBank& registers, Inputs inputs) const;
    class Rows;
    bool compute_together(const Instruction& instruction, const RegisterBank& registers) const;
    bool compute_noise(const Instruction& instruction, const RegisterBank& registers) const;
    bool compute_mapping(const Instruction& instruction, const RegisterBank& registers) const;
    bool compute_mix(const Instruction& instruction, const RegisterBank& registers) const;
    void compute_checker(const Instruction& instruction, const RegisterBank& registers) const;
    void compute_table(const Instruction& instruction, const RegisterBank& registers) const;
    void compute_component(const Instruction& instruction, const RegisterBank& registers) const;
    void add_closures(const Instruction& instruction, const RegisterBank& registers, Inputs inputs,
                      Results results) const;
    void find_even_closures();
    bool copy_even_closures(Inputs inputs, Results results) const;
    void look_up(const Instruction& instruction, std::span<const RegisterBank> places, Inputs inputs) const;
    void bend(const Instruction& instruction, std::span<const RegisterBank> places, Inputs inputs) const;
    void probe(const Instruction& instruction, std::span<const RegisterBank> places, Inputs inputs) const;
    void run(Inputs inputs, const RegisterBank& registers, Results results) const;
    void run_textured(Inputs inputs, std::span<const RegisterBank> places, Results results) const;
    template <typename Function>
    void with_registers(size_t points, Function function) const;
    void execute(Inputs inputs, float* numbers, Results results) const;

    std::string name_;
    BumpShadow bump_shadow_;
    Clearing clearing_;
    float bump_width_ = 1.0f;
    std::vector<Instruction> instructions_;
    std::vector<Register> operands_;
    std::vector<int32_t> ints_;
    std::vector<float> floats_;
    std::vector<Vec4f> registers_;  ///< initial contents
    std::vector<int32_t> origins_;  ///< per register: the instruction that writes it, or kConstant
    bool emits_ = false, scatters_ = false, transparent_ = false, constant_ = true;
    bool reads_inputs_ = false, reads_uv_ = false, reads_element_ = false, reads_generated_ = false;
    bool varies_in_space_ = false;
    bool reads_pixels_ = false;  ///< wireframe in pixels
    bool asks_surroundings_ = false;
    bool textured_ = false;                   ///< some instruction is differentiated, or reads an image
    bool bends_ = false;                      ///< some instruction is a bump
    bool differentiates_attributes_ = false;  ///< and reads a named attribute
    bool differentiates_generated_ = false;   ///< and reads a place in the object's texture space
    bool closures_turn_alone_ = true;         ///< closures differ between points by normal, side and path alone
    /// Where they do, and nothing is read: what is added at any point (shading/even_closures.h). Else null.
    std::shared_ptr<const EvenClosures> even_closures_;
};

}  // namespace rayleaf
