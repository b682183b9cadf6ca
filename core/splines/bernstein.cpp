#include "splines/bernstein.h"

#include "base/assert.h"

#include <algorithm>

namespace rayleaf {

namespace {

/// One step of the triangular recurrence: values of degree `from` become those of degree `from` + 1, in place.
void raise_basis(int from, double s, double t, double* values) {
    values[from + 1] = values[from] * t;
    for (int i = from; i > 0; --i) values[i] = values[i] * s + values[i - 1] * t;
    values[0] *= s;
}

}  // namespace

void bernstein_values(int degree, double t, double* values) {
    values[0] = 1.0;
    for (int k = 0; k < degree; ++k) raise_basis(k, 1.0 - t, t, values);
}

BernsteinBasis::BernsteinBasis(int degree, double t) : degree_(degree), values_(3 * (static_cast<size_t>(degree) + 1)) {
    RAYLEAF_ASSERT_GE(degree, 0);
    double* value = values_.data();
    double* lower = value + degree + 1;
    double* lowest = lower + degree;
    value[0] = 1.0;
    for (int k = 0; k < degree; ++k) {
        if (k == degree - 2) std::copy_n(value, k + 1, lowest);
        if (k == degree - 1) std::copy_n(value, k + 1, lower);
        raise_basis(k, 1.0 - t, t, value);
    }
}

void subdivide(int degree, double t, Vec4d* points, Vec4d* right, int stride) {
    const double s = 1.0 - t;
    for (int i = 0; i <= degree; ++i) right[i * stride] = points[i * stride];
    for (int level = 1; level <= degree; ++level) {
        for (int i = 0; i <= degree - level; ++i)
            right[i * stride] = right[i * stride] * s + right[(i + 1) * stride] * t;
        points[level * stride] = right[0];
    }
}

void elevate(int degree, const Vec4d* points, int stride, Vec4d* elevated, int elevated_stride) {
    elevated[0] = points[0];
    for (int i = 1; i <= degree; ++i) {
        const double share = static_cast<double>(i) / (degree + 1);
        elevated[i * elevated_stride] = points[(i - 1) * stride] * share + points[i * stride] * (1.0 - share);
    }
    elevated[(degree + 1) * elevated_stride] = points[degree * stride];
}

}  // namespace rayleaf
