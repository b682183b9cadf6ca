// Sums of floats without rounding: the same in any order, also for parts that are summed separately and then joined.
//
// A fixed-point number, wide enough for every float, in digits of 32 bits. Each is kept in 64, so that carries wait
// until the sum is read (Neal 2015, "Fast exact summation using small and large superaccumulators"). What was added
// last stays in a double for as long as that holds it exactly, which is nearly always.
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
    void add(float value) { add_double(value); }
    /// Adds a term of another sum.
    void add_term(double term);
    static bool is_term(double value);

    /// Doubles that add up to the sum exactly, the largest first. Equal sums have equal terms; the first is the sum in
    /// double precision. Unused terms are 0.
    Terms terms() const;

  private:
    static constexpr int kDigitBits = 32, kDigits = 10;
    std::array<int64_t, kDigits> digits_{};  ///< the least first, in units of kUnit
    double last_ = 0.0;                      ///< is added to them

    void add_double(double value) {
        const double sum = last_ + value;
        // One of the differences is the sum's to the larger of the two, which is exact.
        if (sum - last_ == value && sum - value == last_)
            last_ = sum;
        else
            start_again(value);
    }
    void start_again(double value);
    void add_to_digits(double term);
};

}  // namespace rayleaf
