#include "shading/interference.h"

#include "shading/spectrum.h"

#include <array>
#include <complex>
#include <vector>

namespace rayleaf {
namespace {

// Of the standard observer: the Fourier transform of each channel's sensitivity, at paths a step apart. To be
// interpolated, it is turned back by the phase of a wavelength in the middle of the channel.
constexpr float kPathStep = 20.0f;        // nanometres
constexpr float kLongestPath = 30000.0f;  // by there what is seen has fallen below a thousandth
constexpr size_t kPathSteps = static_cast<size_t>(kLongestPath / kPathStep);
constexpr std::array kCentralWavelength = {600.0f, 545.0f, 450.0f};  // nanometres

using Transform = std::array<std::complex<float>, 3>;

std::complex<float> turned(float turns) {
    return std::polar(1.0f, 2.0f * kPi * (turns - std::floor(turns)));
}

Transform transform_at(float path) {
    Transform result{};
    for (const Sensitivity& each : rec709_sensitivities())
        for (int c = 0; c < 3; ++c) {
            const auto i = static_cast<size_t>(c);
            result[i] += each.color[c] * turned(path / each.nanometres - path / kCentralWavelength[i]);
        }
    return result;
}

const std::vector<Transform>& transforms() {
    static const auto kTransforms = [] {
        std::vector<Transform> result(kPathSteps + 1);
        for (size_t i = 0; i <= kPathSteps; ++i) result[i] = transform_at(kPathStep * static_cast<float>(i));
        return result;
    }();
    return kTransforms;
}

Color seen_by_standard(float path, const Color& phase) {
    const float place = path / kPathStep;
    if (!(place < static_cast<float>(kPathSteps))) return Color(0.0f);
    const auto first = static_cast<size_t>(place);
    const float share = place - static_cast<float>(first);
    const Transform &a = transforms()[first], &b = transforms()[first + 1];
    Color result(0.0f);
    for (int c = 0; c < 3; ++c) {
        const auto i = static_cast<size_t>(c);
        const std::complex<float> between = a[i] * (1.0f - share) + b[i] * share;
        result[c] = (between * turned(path / kCentralWavelength[i]) * std::polar(1.0f, phase[c])).real();
    }
    return result;
}

// Gaussian curves of the wave number 2 pi / wavelength (Belcour and Barla 2017, supplemental code).

/// A curve's integral over that of its channel, its middle (1/m), and its variance (1/m²).
struct Curve {
    float integral, middle, variance;
};

float transform_of(const Curve& curve, float metres, float phase) {
    return curve.integral * std::cos(curve.middle * metres + phase) * std::exp(-curve.variance * metres * metres);
}

Color seen_by_gaussians(float path, const Color& phase) {
    constexpr Curve kRed{0.8462f, 1.6810e6f, 4.3278e9f}, kRedAgain{0.1538f, 2.2399e6f, 4.5282e9f};
    constexpr Curve kGreen{1.0f, 1.7953e6f, 9.3046e9f}, kBlue{1.0f, 2.2084e6f, 6.6121e9f};
    const float metres = 2.0f * kPi * path * 1e-9f;
    const auto xyz = [&](float p) {
        return Vec3f(transform_of(kRed, metres, p) + transform_of(kRedAgain, metres, p),
                     transform_of(kGreen, metres, p), transform_of(kBlue, metres, p));
    };
    // Each of X, Y, Z is relative to white, which here is D65; rows of the matrix add up to 1.
    return {Vec3f(3.0799f, -1.5371f, -0.5428f).dot(xyz(phase.x)), Vec3f(-0.9213f, 1.8760f, 0.0453f).dot(xyz(phase.y)),
            Vec3f(0.0529f, -0.2040f, 1.1511f).dot(xyz(phase.z))};
}

}  // namespace

Color seen_interference(FilmObserver observer, float path, const Color& phase) {
    return observer == FilmObserver::Gaussians ? seen_by_gaussians(path, phase) : seen_by_standard(path, phase);
}

}  // namespace rayleaf
