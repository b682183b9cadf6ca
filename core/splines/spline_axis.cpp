#include "splines/spline_axis.h"

#include <algorithm>

namespace rayleaf {

size_t SplineAxis::span_at(double parameter) const {
    const auto later = std::upper_bound(spans.begin(), spans.end(), parameter,
                                        [](double t, const SplineSpan& s) { return t < s.begin; });
    return later == spans.begin() ? 0 : static_cast<size_t>(later - spans.begin()) - 1;
}

double SplineAxis::local_parameter(size_t span, double parameter) const {
    const SplineSpan& s = spans[span];
    return std::clamp((parameter - s.begin) / (s.end - s.begin), 0.0, 1.0);
}

}  // namespace rayleaf
