// What an operation is given at run time: its operands' registers.
#pragma once

#include "base/vector.h"

#include <cstdint>

namespace rayleaf {

class Operands {
  public:
    Operands(const Vec4f* registers, const int32_t* indices, uint32_t count)
        : registers_(registers), indices_(indices), count_(count) {}

    /// False where the operand was left out or is -1.
    bool connected(uint32_t i) const { return i < count_ && indices_[i] >= 0; }
    const Vec4f& value(uint32_t i) const { return registers_[indices_[i]]; }
    float scalar(uint32_t i, float otherwise = 0.0f) const { return connected(i) ? value(i).x : otherwise; }
    Vec3f vector(uint32_t i, const Vec3f& otherwise = Vec3f(0.0f)) const {
        if (!connected(i)) return otherwise;
        const Vec4f& v = value(i);
        return {v.x, v.y, v.z};
    }

  private:
    const Vec4f* registers_;
    const int32_t* indices_;
    uint32_t count_;
};

/// A scalar as registers hold it.
inline Vec4f spread(float x) {
    return Vec4f(x, x, x, x);
}
/// A vector or colour as registers hold it.
inline Vec4f extended(const Vec3f& v, float w = 1.0f) {
    return Vec4f(v.x, v.y, v.z, w);
}

inline float saturate(float x) {
    return std::clamp(x, 0.0f, 1.0f);
}
inline Vec3f saturate(const Vec3f& v) {
    return {saturate(v.x), saturate(v.y), saturate(v.z)};
}

}  // namespace rayleaf
