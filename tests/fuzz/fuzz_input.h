// Numbers and choices drawn from a fuzzer's bytes: plain ones mostly, and the ones that break things.
#pragma once

#include "base/error.h"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace rayleaf::fuzz {

class Bytes {
  public:
    Bytes(const uint8_t* data, size_t size) : left_(data, size) {}

    bool empty() const { return left_.empty(); }
    uint8_t byte() {
        if (left_.empty()) return 0;
        const uint8_t value = left_.front();
        left_ = left_.subspan(1);
        return value;
    }
    bool flag() { return (byte() & 1) != 0; }
    /// From now on, small numbers only.
    void tame() { tame_ = true; }
    /// 0 .. most.
    int count(int most) { return byte() % (most + 1); }
    /// A few small numbers, some that are stiff, and any bits of a double.
    double number() {
        constexpr double kTried[] = {0,    1,      -1,    0.5,    2,         1e-6,  1e6,  -1e6, 1e-30,
                                     1e30, 1e-300, 1e300, -1e300, 1.0 / 3.0, 1e-12, 3e38, 1e38};
        const uint8_t kind = byte();
        if (kind < 128 || tame_) return (static_cast<int>(byte()) - 128) / 16.0;
        if (kind < 200) return kTried[kind % std::size(kTried)];
        if (kind < 208) return std::numeric_limits<double>::quiet_NaN();
        if (kind < 216) return std::numeric_limits<double>::infinity();
        uint64_t bits = 0;
        for (int i = 0; i < 8; ++i) bits = bits << 8 | byte();
        double value = 0;
        std::memcpy(&value, &bits, sizeof value);
        return value;
    }
    /// Seldom 1, mostly 0: what to add to a length so that it does not fit.
    size_t odd_length() { return byte() == 7 ? 1 : 0; }
    /// Everything that is left.
    std::span<const uint8_t> rest() {
        const std::span<const uint8_t> all = left_;
        left_ = {};
        return all;
    }
    std::vector<float> floats(size_t size) {
        std::vector<float> values(size);
        for (float& value : values) value = static_cast<float>(number());
        return values;
    }
    std::vector<int32_t> indices(size_t size, int most) {
        std::vector<int32_t> values(size);
        for (int32_t& value : values) value = flag() || most == 0 ? static_cast<int8_t>(byte()) : byte() % most;
        return values;
    }

    /// Of a wanted length, seldom one more.
    std::vector<float> ill_fitting_floats(size_t size) { return floats(size + odd_length()); }
    std::vector<int32_t> ill_fitting_indices(size_t size, int most) { return indices(size + odd_length(), most); }
    /// A material slot for each of so many, or none at all.
    std::vector<int32_t> slots(size_t size) { return flag() ? ill_fitting_indices(size, 4) : std::vector<int32_t>(); }

  private:
    std::span<const uint8_t> left_;
    bool tame_ = false;
};

/// Runs a function that may refuse its input by InputError, and by nothing else.
template <typename Function>
void refusing(Function function) {
    try {
        function();
    } catch (const InputError&) {  // a clear message is a right answer
    }
}

/// Ends the run, so that the fuzzer keeps the input.
inline void require(bool holds, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    if (holds) return;
    std::fprintf(stderr, "%s:%d: not so\n", file, line);
    std::abort();
}

}  // namespace rayleaf::fuzz
