#include "film/exact_sum.h"

#include "base/assert.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace rayleaf {
namespace {

/// The rounded sum; the rounding error is left in `b` (Knuth's TwoSum).
double add_keeping_error(double a, double& b) {
    const double sum = a + b, of_b = sum - a;
    b = (a - (sum - of_b)) + (b - of_b);
    return sum;
}

}  // namespace

/// Where the double cannot hold both, the sum so far goes to the digits.
void ExactSums::add_double(size_t sum, double value) {
    constexpr double kLargest = std::numeric_limits<float>::max();
    const double last = last_[sum / 2][sum % 2], both = last + value;
    if (both - last == value && both - value == last) {
        last_[sum / 2][sum % 2] = both;
    } else if (!std::isnan(value)) {
        add_to_digits(last, digits_[sum]);
        last_[sum / 2][sum % 2] = std::isinf(value) ? std::copysign(kLargest, value) : value;
    }
}

void ExactSums::add_to_digits(double term, Digits& digits) {
    constexpr int kFractionBits = 52, kUnitExponent = 1075 - 149;  // of an IEEE double that is a whole number of units
    constexpr uint64_t kImplicitBit = uint64_t{1} << kFractionBits, kDigit = 0xffffffffu;
    const auto bits = std::bit_cast<uint64_t>(term);
    uint64_t mantissa = (bits & (kImplicitBit - 1)) | kImplicitBit;
    int position = static_cast<int>((bits >> kFractionBits) & 0x7ff) - kUnitExponent;
    if (position < -kFractionBits) return;  // zero
    if (position < 0) {
        mantissa >>= -position;
        position = 0;
    }
    for (; mantissa != 0; mantissa >>= kDigitBits, position += kDigitBits) {
        const uint64_t shifted = (mantissa & kDigit) << (position % kDigitBits);
        const auto low = static_cast<int64_t>(shifted & kDigit), high = static_cast<int64_t>(shifted >> kDigitBits);
        const auto digit = static_cast<size_t>(position / kDigitBits);
        digits[digit] += term < 0.0 ? -low : low;
        digits[digit + 1] += term < 0.0 ? -high : high;
    }
}

void ExactSums::add_term(size_t sum, double term) {
    RAYLEAF_ASSERT_OP(is_term(term), ==, true);
    add_double(sum, term);
}

bool ExactSums::is_term(double value) {
    return std::abs(value) < kLimit && std::trunc(value / kUnit) == value / kUnit;
}

ExactSums::Terms ExactSums::terms(size_t sum) const {
    const double last = last_[sum / 2][sum % 2];
    Digits digits = digits_[sum];
    if (std::all_of(digits.begin(), digits.end(), [](int64_t digit) { return digit == 0; })) return {last};
    add_to_digits(last, digits);
    std::array<double, kDigits> parts;
    int64_t carry = 0;
    for (int i = 0; i < kDigits; ++i) {
        const int64_t digit = digits[static_cast<size_t>(i)] + carry;
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
