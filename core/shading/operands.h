// What an operation is given at run time: its operands' registers.
//
// A program runs for several points at once. Registers lie apart by component and point, [register][component][point],
// so that what is done for each point can be done for several in the lanes of a vector; with one point they are vectors
// of four.
#pragma once

#include "base/vector.h"

#include <cstddef>
#include <cstdint>

namespace rayleaf {

/// From here on, an operand's index names a constant.
inline constexpr int32_t kFirstConstant = 1 << 30;

/// One number for each point; the next lies `step` further, 0: all points have the same.
struct NumberRow {
    const float* first;
    size_t step;

    float operator[](size_t point) const { return first[point * step]; }
};

/// The registers of all points of a run, and the constants, which all points share.
struct RegisterBank {
    float* numbers = nullptr;
    uint32_t points = 1;
    const Vec4f* constants = nullptr;

    /// A component of a register: one number for each point.
    float* component(int32_t index, uint32_t i) const {
        return numbers + (static_cast<size_t>(index) * 4 + i) * points;
    }
    /// The same of a register or a constant.
    NumberRow row(int32_t index, uint32_t i) const {
        if (index >= kFirstConstant) return {&constants[index - kFirstConstant].x + i, 0};
        return {component(index, i), 1};
    }
    Vec4f value(int32_t index, uint32_t point) const {
        if (index >= kFirstConstant) return constants[index - kFirstConstant];
        const float* at = component(index, 0) + point;
        return Vec4f(at[0], at[points], at[2 * size_t{points}], at[3 * size_t{points}]);
    }
    void set(int32_t index, uint32_t point, const Vec4f& value) const {
        float* at = component(index, 0) + point;
        at[0] = value.x;
        at[points] = value.y;
        at[2 * size_t{points}] = value.z;
        at[3 * size_t{points}] = value.w;
    }
};

/// The operands of one operation at one point.
class Operands {
  public:
    Operands(const RegisterBank& registers, uint32_t point, const int32_t* indices, uint32_t count)
        : registers_(registers), point_(point), indices_(indices), count_(count) {}

    /// False where the operand was left out or is -1.
    bool connected(uint32_t i) const { return i < count_ && indices_[i] >= 0; }
    Vec4f value(uint32_t i) const { return registers_.value(indices_[i], point_); }
    float scalar(uint32_t i, float otherwise = 0.0f) const {
        return connected(i) ? registers_.row(indices_[i], 0)[point_] : otherwise;
    }
    Vec3f vector(uint32_t i, const Vec3f& otherwise = Vec3f(0.0f)) const {
        if (!connected(i)) return otherwise;
        const Vec4f v = value(i);
        return {v.x, v.y, v.z};
    }

  private:
    RegisterBank registers_;
    uint32_t point_;
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

/// Per channel, at least 0.
inline Vec3f not_negative(const Vec3f& v) {
    return {std::max(v.x, 0.0f), std::max(v.y, 0.0f), std::max(v.z, 0.0f)};
}

}  // namespace rayleaf
