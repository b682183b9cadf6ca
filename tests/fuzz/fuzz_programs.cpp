// Shader programs of any operations with any operands: refused with a message, or closures without NaN.
#include "fuzz_input.h"
#include "shading/program.h"

using namespace rayleaf;

namespace {

constexpr const char* kIdentifiers[] = {
#define OPERATION(identifier, ...) #identifier,
#include "shading/operations.def"
#undef OPERATION
};
constexpr const char* kTexts[] = {"", "GGX", "BECKMANN", "SHARP", "MULTI_GGX", "ADD", "LINEAR", "OBJECT", "nonsense"};

std::vector<Register> operands(fuzz::Bytes& bytes, const Program& program) {
    std::vector<Register> drawn(static_cast<size_t>(bytes.count(10)));
    for (Register& each : drawn) each = bytes.byte() % (program.register_count() + 2) - 1;
    return drawn;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    fuzz::Bytes bytes(data, size);
    Program program("drawn");
    for (int i = 0; i < 24 && !bytes.empty(); ++i) {
        fuzz::refusing([&] {
            if (bytes.flag()) {
                const std::vector<float> values = bytes.floats(4);
                program.constant(Vec4f(values[0], values[1], values[2], values[3]));
                return;
            }
            const std::string identifier = kIdentifiers[bytes.byte() % std::size(kIdentifiers)];
            if (identifier == "image" || identifier == "environment") return;  // textures: another target
            const std::vector<Register> read = operands(bytes, program);
            const std::vector<int32_t> ints = bytes.indices(static_cast<size_t>(bytes.count(6)), 8);
            const std::vector<float> floats = bytes.floats(static_cast<size_t>(bytes.count(12)));
            program.operation(identifier, read, ints, floats, kTexts[bytes.byte() % std::size(kTexts)]);
        });
    }
    const CameraInfo camera;
    ShadingInputs inputs;  // those of a world's program
    inputs.camera = &camera;
    inputs.outgoing = Vec3f(0.6f, 0.0f, 0.8f);
    Closures closures;
    program.evaluate(inputs, closures);
    fuzz::require(is_finite(closures.emission) && is_finite(closures.transparency));
    for (int i = 0; i < closures.size(); ++i) fuzz::require(is_finite(closures[i].weight));
    return 0;
}
