#include "shading/phase.h"

#include <algorithm>
#include <cmath>

namespace rayleaf {
namespace {

/// Cycles' limit: nearer to 1 the function is a delta.
constexpr float kLargestG = 0.999f;
/// Below this, Henyey and Greenstein's is uniform to single precision.
constexpr float kLeastG = 1e-3f;
constexpr float kLargestAlpha = 1e6f;
/// Of particles; Cycles' limits, but for the least backscatter: with 0 nothing is turned at all.
constexpr float kLeastIor = 1.001f, kLargestIor = 100.0f, kLeastBackscatter = 1e-3f, kLargestBackscatter = 0.499f;
/// The largest number below 1: Fournier and Forand's density has a pole at 1, and theirs lies below.
constexpr double kNearlyOne = 1.0 - 0x1p-24;

/// Where a distribution on [-1, 1] reaches a share: Newton's method, which halves the range where it would leave it.
template <typename Distribution>
double inverse(const Distribution& distribution, double share, double start) {
    double low = -1.0, high = 1.0, x = start;
    for (int i = 0; i < 60; ++i) {
        const double beyond = distribution.share_below(x) - share;
        (beyond > 0.0 ? high : low) = x;
        const double step = beyond / (2.0 * kPi * distribution.density(x));
        const double next = x - step, last = x;
        x = next > low && next < high ? next : 0.5 * (low + high);
        if (std::abs(x - last) < 1e-9) break;
    }
    return x;
}

/// Draine's in double precision.
struct Draine {
    double g, alpha;

    double density(double cosine) const {
        const double around = 1.0 + g * g - 2.0 * g * cosine;
        return (1.0 - g * g) * (1.0 + alpha * cosine * cosine) /
               (4.0 * kPi * (1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0) * around * std::sqrt(around));
    }
    double share_below(double cosine) const {
        const double norm = 1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0;
        if (std::abs(g) < 1e-4) {  // to first order in g
            const double c2 = cosine * cosine, c3 = c2 * cosine;
            const double even = (cosine + 1.0) + alpha * (c3 + 1.0) / 3.0;
            const double odd = 3.0 * g * ((c2 - 1.0) / 2.0 + alpha * (c2 * c2 - 1.0) / 4.0);
            return (even + odd) / (2.0 * norm);
        }
        // By t, the root of `around`, the density is a sum of powers of t.
        const auto integral = [&](double t) {
            const double sum = 1.0 + g * g, quarter = alpha / (4.0 * g * g);
            return -1.0 / t + quarter * (-sum * sum / t - 2.0 * sum * t + t * t * t / 3.0);
        };
        const double t = std::sqrt(std::max(0.0, 1.0 + g * g - 2.0 * g * cosine));
        return (1.0 - g * g) / (2.0 * g * norm) * (integral(1.0 + g) - integral(t));
    }
};

/// (x^power - 1) / (x - 1), from the logarithm of x.
double ratio_of_powers(double logarithm, double power) {
    return std::abs(logarithm) < 1e-12 ? power : std::expm1(power * logarithm) / std::expm1(logarithm);
}

/// Fournier and Forand's in double precision, with their names.
struct FournierForand {
    double delta_of_back, nu, tail;

    FournierForand(double ior, double backscatter) : delta_of_back(4.0 / (3.0 * (ior - 1.0) * (ior - 1.0))) {
        const double logarithm = std::log(0.5 * delta_of_back);
        nu = std::abs(logarithm) < 1e-9 ? -2.0 * backscatter
                                        : -std::log1p(2.0 * backscatter * std::expm1(logarithm)) / logarithm;
        tail = ratio_of_powers(std::log(delta_of_back), -nu);
    }
    struct Place {
        double sine2, delta, power;  ///< the square of the sine of half the angle
    };
    Place place(double cosine) const {
        double sine2 = 0.5 * (1.0 - std::min(cosine, kNearlyOne)), delta = delta_of_back * sine2;
        if (std::abs(delta - 1.0) < 1e-5) {  // their formulas divide by the square of the difference
            delta = 1.0 + 1e-5;
            sine2 = delta / delta_of_back;
        }
        return {sine2, delta, std::pow(delta, nu)};
    }
    double density(double cosine) const {
        const Place p = place(cosine);
        const double left = 1.0 - p.delta, left_power = 1.0 - p.power;
        const double peak = (nu * left - left_power + (p.delta * left_power - nu * left) / p.sine2) /
                            (4.0 * kPi * left * left * p.power);
        return std::max(peak + tail * (3.0 * cosine * cosine - 1.0) / (16.0 * kPi), 1e-30);
    }
    double share_below(double cosine) const {
        const Place p = place(cosine);
        const double left = 1.0 - p.delta;
        const double peak = (1.0 - p.power * p.delta - (1.0 - p.power) * p.sine2) / (left * p.power);
        return 1.0 - peak - tail * cosine * (1.0 - cosine * cosine) / 8.0;
    }
};

float sampled_henyey_greenstein(float g, float random) {
    if (std::abs(g) < kLeastG) return 1.0f - 2.0f * random;
    const float k = (1.0f - g * g) / (1.0f - g + 2.0f * g * random);
    return std::clamp((1.0f + g * g - k * k) / (2.0f * g), -1.0f, 1.0f);
}

}  // namespace

PhaseFunction draine_phase(float g, float alpha) {
    return {PhaseFunction::Kind::Draine, std::clamp(finite_or_zero(g), -kLargestG, kLargestG),
            std::clamp(finite_or_zero(alpha), 0.0f, kLargestAlpha)};
}

PhaseFunction fournier_forand_phase(float ior, float backscatter) {
    return {PhaseFunction::Kind::FournierForand, std::clamp(finite_or_zero(ior), kLeastIor, kLargestIor),
            std::clamp(std::abs(finite_or_zero(backscatter)), kLeastBackscatter, kLargestBackscatter)};
}

float PhaseFunction::shaped_density(float cosine) const {
    if (kind == Kind::FournierForand) return static_cast<float>(FournierForand(first, second).density(cosine));
    return henyey_greenstein(cosine, first) * (1.0f + second * cosine * cosine) /
           (1.0f + second * (1.0f + 2.0f * first * first) / 3.0f);
}

float PhaseFunction::sample(float random) const {
    if (kind == Kind::FournierForand) return static_cast<float>(inverse(FournierForand(first, second), random, 0.6));
    const float plain = sampled_henyey_greenstein(first, random);
    if (is_plain()) return plain;
    return static_cast<float>(inverse(Draine{first, second}, random, std::clamp(plain, -0.999f, 0.999f)));
}

std::array<PhaseShare, 2> mie_phase(float diameter) {
    const float d = std::clamp(finite_or_zero(diameter), 0.0f, 1e4f), l = std::log(std::max(d, 1e-3f));
    float forward = 0, g = 0, alpha = 250.0f, share = 0;  // the supplement's equations 7 to 22
    if (d <= 0.1f) {
        forward = 13.8f * d * d;
        g = 1.1456f * d * std::sin(9.29044f * d);
        share = 0.252977f - 312.983f * std::pow(d, 4.3f);
    } else if (d < 1.5f) {
        const float turn = (l - 0.238604f) * (l + 1.00667f) / (0.507522f - 0.15677f * l);
        forward = 0.862f - 0.143f * l * l;
        g = 0.379685f * std::cos(1.19692f * std::cos(turn) + 1.37932f * l + 0.0625835f) + 0.344213f;
        share = 0.146209f * std::cos(3.38707f * l + 2.11193f) + 0.316072f + 0.0778917f * l;
    } else if (d < 5.0f) {
        forward = 0.0604931f * std::log(l) + 0.940256f;
        g = 0.500411f - 0.081287f / (-2.0f * l + std::tan(l) + 1.27551f);
        alpha = 7.30354f * l + 6.31675f;
        share = 0.026914f * (l - std::cos(5.68947f * (std::log(l) - 0.0292149f))) + 0.3764f;
    } else {
        forward = std::exp(-0.0990567f / (d - 1.67154f));
        g = std::exp(-2.20679f / (d + 3.91029f) - 0.428934f);
        alpha = std::exp(3.62489f - 8.29288f / (d + 5.52825f));
        share = std::exp(-0.599085f / (d - 0.641583f) - 0.665888f);
    }
    share = std::clamp(share, 0.0f, 1.0f);
    return {{{draine_phase(forward, 0.0f), 1.0f - share}, {draine_phase(g, alpha), share}}};
}

}  // namespace rayleaf
