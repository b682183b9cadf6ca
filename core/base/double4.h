// Four doubles in two SIMD registers: plain IEEE operations on each, so results are the same as computed one by one.
#pragma once

#include "base/vector.h"

#include <cstring>

namespace rayleaf {

struct Double4 {
    using Pair = double __attribute__((vector_size(16)));
    Pair low, high;

    Double4(Pair xy, Pair zw) : low(xy), high(zw) {}
    explicit Double4(const Vec4d& v) {
        std::memcpy(&low, &v.x, sizeof(low));
        std::memcpy(&high, &v.z, sizeof(high));
    }
    double x() const { return low[0]; }
    double y() const { return low[1]; }
    double z() const { return high[0]; }
    double w() const { return high[1]; }
    /// Written as it is held: what is read as pairs soon after would wait for single numbers.
    explicit operator Vec4d() const {
        Vec4d v;
        std::memcpy(&v.x, &low, sizeof(low));
        std::memcpy(&v.z, &high, sizeof(high));
        return v;
    }
};

inline Double4 operator+(const Double4& a, const Double4& b) {
    return {a.low + b.low, a.high + b.high};
}
inline Double4 operator-(const Double4& a, const Double4& b) {
    return {a.low - b.low, a.high - b.high};
}
inline Double4 operator*(const Double4& a, double factor) {
    return {a.low * factor, a.high * factor};
}
inline Double4 operator/(const Double4& a, double by) {
    return {a.low / by, a.high / by};
}
inline Double4 smaller(const Double4& a, const Double4& b) {
    return {a.low < b.low ? a.low : b.low, a.high < b.high ? a.high : b.high};
}
inline Double4 larger(const Double4& a, const Double4& b) {
    return {a.low > b.low ? a.low : b.low, a.high > b.high ? a.high : b.high};
}

}  // namespace rayleaf
