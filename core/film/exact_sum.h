// Sums of floats without rounding: the same in any order, also for parts that are summed separately and then joined.
//
// A fixed-point number, wide enough for every float, in digits of 32 bits. Each is kept in 64, so that carries wait
// until the sum is read (Neal 2015, "Fast exact summation using small and large superaccumulators"). What was added
// last stays in a double for as long as that holds it exactly, which is nearly always. Four sums lie side by side, so
// that values are added to them together.
#pragma once

#include "base/vector.h"

#include <array>
#include <cstdint>

namespace rayleaf {

class ExactSums {
    using Pair = double __attribute__((vector_size(16)));

  public:
    /// Doubles that add up to any sum of less than 2^31 floats.
    static constexpr int kMostTerms = 8;
    /// They and the sum are multiples of kUnit, the least float; none is as large as kLimit.
    static constexpr double kUnit = 0x1p-149, kLimit = 0x1p159;
    using Terms = std::array<double, kMostTerms>;

    /// Infinity counts as the largest float; NaN is ignored.
    void add(const Vec4f& values) {
        const Pair added[2] = {{values.x, values.y}, {values.z, values.w}};
        const Pair sums[2] = {last_[0] + added[0], last_[1] + added[1]};
        // One of the differences is the sum's to the larger of the two, which is exact.
        const auto rounded = (sums[0] - last_[0] != added[0]) | (sums[0] - added[0] != last_[0]) |
                             (sums[1] - last_[1] != added[1]) | (sums[1] - added[1] != last_[1]);
        if ((rounded[0] | rounded[1]) == 0) {
            last_[0] = sums[0];
            last_[1] = sums[1];
        } else {
            for (size_t i = 0; i < 4; ++i) add_double(i, added[i / 2][i % 2]);
        }
    }
    /// Adds a term of another sum to that of a number.
    void add_term(size_t sum, double term);
    static bool is_term(double value);

    /// Doubles that add up to the sum exactly, the largest first. Equal sums have equal terms; the first is the sum in
    /// double precision. Unused terms are 0.
    Terms terms(size_t sum) const;

  private:
    static constexpr int kDigitBits = 32, kDigits = 10;
    using Digits = std::array<int64_t, kDigits>;  ///< the least first, in units of kUnit
    Pair last_[2]{};                              ///< is added to the digits
    std::array<Digits, 4> digits_{};

    void add_double(size_t sum, double value);
    static void add_to_digits(double term, Digits& digits);
};

}  // namespace rayleaf
