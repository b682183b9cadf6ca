// Sums of floats without rounding: the same in any order, also for parts that are summed separately and then joined.
//
// A fixed-point number, wide enough for every float, in digits of 32 bits. Each is kept in 64, so that carries wait
// until the sum is read (Neal 2015, "Fast exact summation using small and large superaccumulators").
#pragma once

#include <array>
#include <cstdint>

namespace rayleaf {

class ExactSum {
  public:
    /// Doubles that add up to any sum of less than 2^31 floats.
    static constexpr int kMostTerms = 8;
    /// They and the sum are multiples of kUnit, the least float; none is as large as kLimit.
    static constexpr double kUnit = 0x1p-149, kLimit = 0x1p159;
    using Terms = std::array<double, kMostTerms>;

    /// Infinity counts as the largest float; NaN is ignored.
    void add(float value);
    /// Adds a term of another sum.
    void add_term(double term);
    static bool is_term(double value);

    /// Doubles that add up to the sum exactly, the largest first. Equal sums have equal terms; the first is the sum in
    /// double precision. Unused terms are 0.
    Terms terms() const;

  private:
    static constexpr int kDigitBits = 32, kDigits = 10;
    std::array<int64_t, kDigits> digits_{};  ///< the least first, in units of kUnit

    void add(uint64_t mantissa, int position, bool negative);
};

}  // namespace rayleaf
