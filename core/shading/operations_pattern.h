// Operations that compute textures from their coordinate alone.
#pragma once

#include "shading/operands.h"
#include "shading/operation.h"

#include <cstdint>
#include <span>

namespace rayleaf {

/// A coordinate of a texture: what is not finite, and beyond what textures can tell apart, counts as 0.
inline float sound_coordinate(float x) {
    constexpr float kFarthest = 1e18f;  // its square is finite
    return std::abs(x) < kFarthest ? x : 0.0f;
}

/// The value of one of the table's operations of this kind, from operands and integers as written there; of others 0.
Vec4f pattern_value(Operation operation, uint8_t variant, const Operands& operands, std::span<const int32_t> ints);

}  // namespace rayleaf
