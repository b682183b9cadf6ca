#include "film/exact_sum.h"

#include "base/assert.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace rayleaf {
namespace {

/// The rounded sum; the rounding error is left in `b` (Knuth's TwoSum).
double add_keeping_error(double a, double& b) {
    const double sum = a + b, of_b = sum - a;
    b = (a - (sum - of_b)) + (b - of_b);
    return sum;
}

}  // namespace

/// Adds `mantissa`, of at most 32 bits, shifted by `position`.
void ExactSum::add(uint64_t mantissa, int position, bool negative) {
    const uint64_t shifted = mantissa << (position % kDigitBits);
    const auto low = static_cast<int64_t>(shifted & 0xffffffffu), high = static_cast<int64_t>(shifted >> kDigitBits);
    const auto digit = static_cast<size_t>(position / kDigitBits);
    digits_[digit] += negative ? -low : low;
    digits_[digit + 1] += negative ? -high : high;
}

void ExactSum::add(float value) {
    constexpr uint32_t kImplicitBit = 1u << 23, kFraction = kImplicitBit - 1, kSpecial = 255;
    const auto bits = std::bit_cast<uint32_t>(value);
    uint32_t exponent = (bits >> 23) & 0xff, fraction = bits & kFraction;
    if (exponent == kSpecial) {
        if (fraction != 0) return;
        exponent = kSpecial - 1;
        fraction = kFraction;
    }
    const bool negative = (bits >> 31) != 0;
    if (exponent == 0)
        add(fraction, 0, negative);
    else
        add(fraction | kImplicitBit, static_cast<int>(exponent) - 1, negative);
}

void ExactSum::add_term(double term) {
    RAYLEAF_ASSERT_OP(is_term(term), ==, true);
    const bool negative = std::signbit(term);
    for (double rest = std::abs(term); rest > 0.0;) {  // 32 bits at a time
        const int position = std::max(0, std::ilogb(rest / kUnit) - (kDigitBits - 1));
        const double mantissa = std::floor(std::ldexp(rest / kUnit, -position));
        add(static_cast<uint64_t>(mantissa), position, negative);
        rest -= std::ldexp(mantissa, position) * kUnit;
    }
}

bool ExactSum::is_term(double value) {
    return std::abs(value) < kLimit && std::trunc(value / kUnit) == value / kUnit;
}

ExactSum::Terms ExactSum::terms() const {
    std::array<double, kDigits> parts;
    int64_t carry = 0;
    for (int i = 0; i < kDigits; ++i) {
        const int64_t digit = digits_[static_cast<size_t>(i)] + carry;
        // Digits from -2^31 to 2^31 - 1 make the form unique. The highest digit, of a few bits, stays.
        const int64_t kept = i + 1 < kDigits ? static_cast<int32_t>(static_cast<uint32_t>(digit)) : digit;
        carry = (digit - kept) / (int64_t{1} << kDigitBits);
        parts[static_cast<size_t>(i)] = std::ldexp(static_cast<double>(kept), kDigitBits * i) * kUnit;
    }
    Terms terms{};
    for (double& term : terms) {
        for (double& part : parts) term = add_keeping_error(term, part);
        if (std::all_of(parts.begin(), parts.end(), [](double part) { return part == 0.0; })) break;
    }
    return terms;
}

}  // namespace rayleaf
