// Operations that ask what is around the point.
#pragma once

#include "shading/inputs.h"
#include "shading/operands.h"
#include "shading/operation.h"

#include <span>

namespace rayleaf {

constexpr bool is_probe(Operation operation) {
    return operation == Operation::ambient_occlusion || operation == Operation::bevel ||
           operation == Operation::raycast;
}

/// `tag` distinguishes the queries of one program. Where rays cannot be traced nothing is near: in displacement, lamps,
/// media and the surfaces that a shadow ray goes through (as in Cycles).
Vec4f surroundings_value(Operation operation, const Operands& operands, std::span<const int32_t> ints,
                         const ShadingInputs& inputs, uint32_t tag);

}  // namespace rayleaf
