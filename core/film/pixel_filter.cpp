#include "film/pixel_filter.h"

#include <vector>

namespace rayleaf {
namespace {

/// Filter value at `x` in [-1, 1], the share of half the width.
double filter_value(PixelFilterKind kind, double x) {
    switch (kind) {
        case PixelFilterKind::Gaussian: {
            // Six standard deviations in the half width.
            constexpr double kSharpness = 18.0;
            return std::exp(-kSharpness * x * x);
        }
        case PixelFilterKind::BlackmanHarris: {
            // Four-term Blackman-Harris window (Harris 1978, table I, -92 dB).
            const double phase = std::numbers::pi * (x + 1.0);
            return 0.35875 - 0.48829 * std::cos(phase) + 0.14128 * std::cos(2 * phase) - 0.01168 * std::cos(3 * phase);
        }
        case PixelFilterKind::Box:
            break;
    }
    return 1.0;
}

}  // namespace

float PixelFilter::support(PixelFilterKind kind) {
    switch (kind) {
        case PixelFilterKind::Gaussian:
            return 3.0f;
        case PixelFilterKind::BlackmanHarris:
            return 2.0f;
        case PixelFilterKind::Box:
            break;
    }
    return 1.0f;
}

PixelFilter::PixelFilter(PixelFilterKind kind, float width) {
    constexpr int kSteps = 4096;
    std::vector<double> cumulative(kSteps + 1, 0.0);
    for (int i = 0; i < kSteps; ++i)
        cumulative[static_cast<size_t>(i) + 1] =
            cumulative[static_cast<size_t>(i)] + filter_value(kind, (2.0 * i + 1.0) / kSteps - 1.0);
    size_t cell = 0;
    for (int i = 0; i <= kEntries; ++i) {
        const double target = cumulative.back() * i / kEntries;
        while (cell + 1 < kSteps && cumulative[cell + 1] < target) ++cell;
        const double inside = (target - cumulative[cell]) / (cumulative[cell + 1] - cumulative[cell]);
        const double x = 2.0 * (static_cast<double>(cell) + inside) / kSteps - 1.0;
        inverse_[static_cast<size_t>(i)] = static_cast<float>(x * 0.5 * support(kind) * width);
    }
}

}  // namespace rayleaf
