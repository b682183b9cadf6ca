// The table of operations as an enumeration, and what each one takes.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace rayleaf {

enum class Operation : uint8_t {
#define OPERATION(identifier, least, most, description) identifier,
#include "shading/operations.def"
#undef OPERATION
};

/// How an operation's result depends on the hit.
enum class OperationFamily : uint8_t {
    Input,       ///< reads the point, the instance or the path
    Arithmetic,  ///< a pure function of its operands
    Texture,     ///< reads the scene's images
    Closure      ///< adds to the point's closures or AOVs, has no result
};

struct OperationInfo {
    std::string_view identifier;
    int least_operands, most_operands;
    OperationFamily family;
    int least_ints, most_ints;
    bool takes_floats;
};

const OperationInfo& operation_info(Operation operation);
std::optional<Operation> operation_named(std::string_view identifier);

}  // namespace rayleaf
