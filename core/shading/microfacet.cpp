#include "shading/microfacet.h"

#include "base/circle.h"

namespace rayleaf {
namespace {

float square(float x) {
    return x * x;
}

/// Smith's Lambda for Beckmann slopes; `a` is the cotangent over the roughness.
float beckmann_lambda(float a) {
    constexpr float kFar = 8.0f;  // erf(8) is 1 and exp(-64) is 0 in single precision
    if (a >= kFar) return 0.0f;
    const float inverse_root_pi = 1.0f / std::sqrt(kPi);
    return 0.5f * (inverse_root_pi * std::exp(-a * a) / a - std::erfc(a));
}

/// Inverse error function (Giles 2010, "Approximating the erfinv function", single precision).
float inverse_erf(float x) {
    const float w = -std::log((1.0f - x) * (1.0f + x));
    float p = 0.0f;
    if (w < 5.0f) {
        constexpr float kCentral[] = {2.81022636e-08f,  3.43273939e-07f, -3.5233877e-06f,
                                      -4.39150654e-06f, 0.00021858087f,  -0.00125372503f,
                                      -0.00417768164f,  0.246640727f,    1.50140941f};
        for (const float c : kCentral) p = p * (w - 2.5f) + c;
    } else {
        constexpr float kTail[] = {-0.000200214257f, 0.000100950558f, 0.00134934322f, -0.00367342844f, 0.00573950773f,
                                   -0.0076224613f,   0.00943887047f,  1.00167406f,    2.83297682f};
        for (const float c : kTail) p = p * (std::sqrt(w) - 3.0f) + c;
    }
    return p * x;
}

/// A visible Beckmann slope along the viewer's azimuth, unit roughness. The density is proportional to
/// (cos - slope sin) exp(-slope²) where positive; its integral up to b is
/// sqrt(pi)/2 cos (1 + erf b) + sin/2 exp(-b²), solved for b by safeguarded Newton steps.
float beckmann_visible_slope(float cosine, float sine, float random) {
    constexpr int kSteps = 24;           // bisection alone reaches 1e-6 of the interval
    constexpr float kTolerance = 1e-6f;  // of the distribution function
    constexpr float kLowest = -4.5f;     // the Gaussian's tail beyond weighs 1e-10
    const float half_root_pi = 0.5f * std::sqrt(kPi);
    const auto integral = [&](float b) {
        return half_root_pi * cosine * std::erfc(-b) + 0.5f * sine * std::exp(-b * b);
    };
    float low = kLowest, high = sine > 0.0f ? std::min(cosine / sine, -kLowest) : -kLowest;
    const float total = integral(high);
    const float wanted = random * total;
    float b = std::clamp(0.5f * (low + high), low, high);
    for (int i = 0; i < kSteps; ++i) {
        const float error = integral(b) - wanted;
        if (std::abs(error) < kTolerance * total) break;
        (error > 0.0f ? high : low) = b;
        const float slope = (cosine - b * sine) * std::exp(-b * b);
        const float step = b - error / slope;
        b = step > low && step < high ? step : 0.5f * (low + high);
    }
    return b;
}

Vec3f sample_ggx(const Vec3f& stretched, const Vec2f& random) {
    const float length2 = square(stretched.x) + square(stretched.y);
    const Vec3f t1 =
        length2 > 0.0f ? Vec3f(-stretched.y, stretched.x, 0.0f) * (1.0f / std::sqrt(length2)) : Vec3f(1.0f, 0.0f, 0.0f);
    const Vec3f t2 = stretched.cross(t1);
    // A point of the disk, its upper half shrunk to what is seen of the hemisphere.
    const Vec2f at = on_circle(random.y) * std::sqrt(random.x);
    const float room = std::sqrt(std::max(0.0f, 1.0f - at.x * at.x));
    const float share = 0.5f * (1.0f + stretched.z);
    const float p2 = (1.0f - share) * room + share * at.y;
    const float p3 = std::sqrt(std::max(0.0f, 1.0f - at.x * at.x - p2 * p2));
    return t1 * at.x + t2 * p2 + stretched * p3;
}

Vec3f sample_beckmann(const Vec3f& stretched, const Vec2f& random) {
    const float sine = std::sqrt(square(stretched.x) + square(stretched.y));
    const float along = beckmann_visible_slope(stretched.z, sine, random.x);
    constexpr float kMost = 1.0f - 6e-8f;  // erf's inverse is finite below 1
    const float across = inverse_erf(std::clamp(2.0f * random.y - 1.0f, -kMost, kMost));
    const float cos_phi = sine > 0.0f ? stretched.x / sine : 1.0f, sin_phi = sine > 0.0f ? stretched.y / sine : 0.0f;
    const float slope_x = cos_phi * along - sin_phi * across, slope_y = sin_phi * along + cos_phi * across;
    return {-slope_x, -slope_y, 1.0f};
}

}  // namespace

float Microfacets::beckmann_masking(float cosine, float spread2) {
    return spread2 == 0.0f ? 1.0f : 1.0f / (1.0f + beckmann_lambda(cosine / std::sqrt(spread2)));
}

Vec3f Microfacets::sample_visible(const Vec3f& w, const Vec2f& random) const {
    const Vec3f stretched = unit_or(Vec3f(w.x * alpha_x, w.y * alpha_y, w.z), Vec3f(0.0f, 0.0f, 1.0f));
    const bool ggx = distribution == MicrofacetDistribution::Ggx;
    const Vec3f h = ggx ? sample_ggx(stretched, random) : sample_beckmann(stretched, random);
    return unit_or(Vec3f(h.x * alpha_x, h.y * alpha_y, std::max(h.z, 0.0f)), Vec3f(0.0f, 0.0f, 1.0f));
}

}  // namespace rayleaf
