#include "tessellation/dyadic_basis.h"

#include "splines/bernstein.h"

namespace rayleaf {

DyadicBasis::DyadicBasis(int degree, int intervals)
    : degree_(degree), intervals_(intervals), values_((degree + size_t{1}) * (intervals + size_t{1})) {
    std::vector<double> at_parameter(degree + size_t{1});
    for (int k = 0; k <= intervals; ++k) {
        bernstein_values(degree, static_cast<double>(k) / intervals, at_parameter.data());
        for (int i = 0; i <= degree; ++i)
            values_[static_cast<size_t>(i) * (intervals + 1) + k] = static_cast<float>(at_parameter[i]);
    }
}

}  // namespace rayleaf
