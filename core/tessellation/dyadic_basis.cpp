#include "tessellation/dyadic_basis.h"

#include "splines/bernstein.h"

namespace rayleaf {

DyadicBasis::DyadicBasis(int degree, int intervals, int first, int steps)
    : steps_(steps), values_((degree + size_t{1}) * (steps + size_t{1})) {
    std::vector<double> at_parameter(degree + size_t{1});
    for (int k = 0; k <= steps; ++k) {
        bernstein_values(degree, static_cast<double>(first + k) / intervals, at_parameter.data());
        for (int i = 0; i <= degree; ++i)
            values_[static_cast<size_t>(i) * (steps + size_t{1}) + k] = static_cast<float>(at_parameter[i]);
    }
}

}  // namespace rayleaf
