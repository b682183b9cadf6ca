#include "shading/lobe_fibre.h"

#include "shading/fresnel.h"

#include <array>

namespace rayleaf {
namespace {

constexpr float kHalfPi = 0.5f * kPi;
/// Angle to the fibre's own direction below which nothing is scattered: the distributions by angles have poles there.
constexpr float kLeastAngle = 1e-3f;

float limited_asin(float x) {
    return std::asin(std::clamp(x, -1.0f, 1.0f));
}
float power(float x, int n) {
    float result = 1.0f;
    for (int i = 0; i < n; ++i) result *= x;
    return result;
}

// --- Hair BSDF ---------------------------------------------------------------------------------------------------

/// The inclinations to the plane across the fibre, and the Cauchy distribution of their mean.
struct Inclination {
    Vec3f along, towards_viewer;  ///< unit, the second across the fibre
    float viewer;                 ///< of the viewer, radians
    float low, high;              ///< the distribution's cumulative angle at both ends

    Inclination(const Lobe& lobe, const Vec3f& outgoing) : along(lobe.tangent) {
        const float sine = std::clamp(along.dot(outgoing), -1.0f, 1.0f);
        Vec3f across, up;
        orthonormal_basis(along, across, up);
        towards_viewer = normalized_or(outgoing - along * sine, across);
        viewer = std::asin(sine);
        high = std::atan((0.5f * (kHalfPi + viewer) - lobe.tilt) / lobe.alpha_x);
        low = std::atan((0.5f * (viewer - kHalfPi) - lobe.tilt) / lobe.alpha_x);
    }
    /// Per solid angle; `deviation` of the mean inclination from the lobe's tilt.
    float density(const Lobe& lobe, float deviation, float inclination) const {
        const float spread = deviation * deviation + lobe.alpha_x * lobe.alpha_x;
        return lobe.alpha_x / (2.0f * spread * (high - low) * std::cos(inclination));
    }
};

/// Per radian around the fibre; `turn` is the angle from the viewer, 0..pi.
float azimuthal_density(const Lobe& lobe, float turn) {
    const float width = lobe.alpha_y;
    if (lobe.type == LobeType::HairReflection) {
        if (turn > kHalfPi) return 0.0f;
        return std::cos(0.5f * std::min(turn / width, kPi)) * 0.25f / width;
    }
    const float from_behind = kPi - turn;
    return width / (2.0f * std::atan(kHalfPi / width) * (from_behind * from_behind + width * width));
}

LobeValue evaluate_hair(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& incoming) {
    const Inclination inclined(lobe, outgoing);
    const float sine = std::clamp(inclined.along.dot(incoming), -1.0f, 1.0f), inclination = std::asin(sine);
    if (kHalfPi - std::abs(inclination) < kLeastAngle) return {};
    const Vec3f around = normalized_or(incoming - inclined.along * sine, inclined.towards_viewer);
    const float turn = std::acos(std::clamp(around.dot(inclined.towards_viewer), -1.0f, 1.0f));
    const float deviation = 0.5f * (inclination + inclined.viewer) - lobe.tilt;
    const float density = inclined.density(lobe, deviation, inclination) * azimuthal_density(lobe, turn);
    return {lobe.weight * density, density};
}

std::optional<LobeDirection> sample_hair(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& random) {
    const Inclination inclined(lobe, outgoing);
    const float deviation = lobe.alpha_x * std::tan(inclined.low + random.x * (inclined.high - inclined.low));
    const float inclination = 2.0f * (deviation + lobe.tilt) - inclined.viewer;
    if (kHalfPi - std::abs(inclination) < kLeastAngle) return std::nullopt;
    const bool through = lobe.type == LobeType::HairTransmission;
    const float turn = through
                           ? kPi + lobe.alpha_y * std::tan(2.0f * std::atan(kHalfPi / lobe.alpha_y) * (random.y - 0.5f))
                           : 2.0f * limited_asin(1.0f - 2.0f * random.y) * lobe.alpha_y;
    const Vec3f sideways = inclined.towards_viewer.cross(inclined.along);
    const float cosine = std::cos(inclination);
    LobeDirection result{inclined.towards_viewer * (cosine * std::cos(turn)) - sideways * (cosine * std::sin(turn)) +
                         inclined.along * std::sin(inclination)};
    result.through = through;
    return result;
}

// --- Principled Hair BSDF ----------------------------------------------------------------------------------------

constexpr int kPaths = 4;  ///< reflected, through, reflected once inside, and all longer ones

/// Density of the logistic distribution of scale `s` on [-pi, pi].
struct TrimmedLogistic {
    float s, tail;  ///< the second: what lies below -pi of the whole one

    explicit TrimmedLogistic(float scale) : s(scale), tail(1.0f / (1.0f + std::exp(std::min(kPi / scale, 88.0f)))) {}
    float density(float x) const {
        const float e = std::exp(-std::abs(x) / s);
        return e / (s * (1.0f + e) * (1.0f + e) * (1.0f - 2.0f * tail));
    }
    float sample(float u) const {
        const float share = u * (1.0f - 2.0f * tail) + tail;
        return std::clamp(-s * std::log(1.0f / share - 1.0f), -kPi, kPi);
    }
};

/// Modified Bessel function of the first kind and order 0, by its series; good up to 12.
float bessel(float x) {
    constexpr int kTerms = 24;
    const float quarter = 0.25f * x * x;
    float term = 1.0f, sum = 1.0f;
    for (int i = 1; i < kTerms; ++i) {
        term *= quarter / static_cast<float>(i * i);
        sum += term;
    }
    return sum;
}
float log_bessel(float x) {
    if (x <= 12.0f) return std::log(bessel(x));
    return x + 0.5f * (1.0f / (8.0f * x) - std::log(2.0f * kPi) - std::log(x));
}

/// A fibre as the viewer sees it, and the attenuation along each of the four paths through it.
struct Fibre {
    Vec3f x, y, z;  ///< x along the fibre, z towards the viewer, turned away
    SineCosine out;
    float turn_out, angle_out, angle_inside;  ///< around the fibre; between ray and normal there, outside and inside
    std::array<Color, kPaths> attenuation;
    std::array<float, kPaths> share;  ///< of sampling

    Fibre(const Lobe& lobe, const Vec3f& outgoing) : x(lobe.tangent) {
        Vec3f across, up;
        orthonormal_basis(x, across, up);
        y = normalized_or(x.cross(outgoing), across);
        z = x.cross(y);
        out.sine = std::clamp(x.dot(outgoing), -1.0f, 1.0f);
        out.cosine = cosine_of(out.sine);
        turn_out = std::atan2(z.dot(outgoing), y.dot(outgoing));
        const float eta = lobe.ior, inside_sine = out.sine / eta;
        angle_out = limited_asin(lobe.across);
        // By the index that the plane across the fibre sees (Marschner et al. 2003, appendix B).
        const float sine = lobe.across * out.cosine / std::sqrt(std::max(eta * eta - out.sine * out.sine, 1e-6f));
        angle_inside = limited_asin(sine);
        const float length = 2.0f * cosine_of(sine) / std::max(cosine_of(inside_sine), 1e-6f);
        const Color passed(std::exp(-lobe.fresnel_0.x * length), std::exp(-lobe.fresnel_0.y * length),
                           std::exp(-lobe.fresnel_0.z * length));
        set_attenuation(dielectric_fresnel(out.cosine * cosine_of(lobe.across), eta), passed);
    }

    /// By how much a path turns light around the fibre.
    float deviation(int path) const {
        const auto p = static_cast<float>(path);
        return 2.0f * p * angle_inside - 2.0f * angle_out + p * kPi;
    }

  private:
    void set_attenuation(float reflected, const Color& passed) {
        attenuation[0] = Color(reflected);
        attenuation[1] = passed * ((1.0f - reflected) * (1.0f - reflected));
        attenuation[2] = attenuation[1] * passed * reflected;
        const Color again = passed * reflected;
        for (int c = 0; c < 3; ++c)
            attenuation[3][c] = again[c] < 1.0f ? attenuation[2][c] * again[c] / (1.0f - again[c]) : 0.0f;
        float sum = 0.0f;
        for (int i = 0; i < kPaths; ++i) {
            share[i] = (attenuation[i].x + attenuation[i].y + attenuation[i].z) / 3.0f;
            sum += share[i];
        }
        for (float& each : share) each = sum > 0.0f ? each / sum : 1.0f / kPaths;
    }
};

/// The variance of a path: through the fibre it is halved in width, after a reflection inside doubled.
float variance_of(const Lobe& lobe, int path) {
    if (path == 0) return lobe.roughness;
    return lobe.alpha_x * (path == 1 ? 0.25f : 4.0f);
}

/// The direction turned by what the scales of the cuticle tilt a path by.
SineCosine tilted(const SineCosine& in, float tilt, int path) {
    constexpr std::array kTilts = {2.0f, -1.0f, -4.0f, 0.0f};
    const float angle = kTilts[static_cast<size_t>(path)] * tilt, s = std::sin(angle), c = std::cos(angle);
    return {in.sine * c + in.cosine * s, std::abs(in.cosine * c - in.sine * s)};
}

float wrapped(float angle) {
    return angle - 2.0f * kPi * std::floor((angle + kPi) / (2.0f * kPi));
}

LobeValue evaluate_fibre(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& incoming) {
    const Fibre fibre(lobe, outgoing);
    SineCosine in{std::clamp(fibre.x.dot(incoming), -1.0f, 1.0f), 0.0f};
    in.cosine = cosine_of(in.sine);
    const float turn = std::atan2(fibre.z.dot(incoming), fibre.y.dot(incoming)) - fibre.turn_out;
    const TrimmedLogistic around(lobe.alpha_y);
    LobeValue sum;
    for (int path = 0; path < kPaths; ++path) {
        const float along = longitudinal_density(tilted(in, lobe.tilt, path), fibre.out, variance_of(lobe, path));
        const float density = along * (path < 3 ? around.density(wrapped(turn - fibre.deviation(path))) : 0.5f / kPi);
        const auto i = static_cast<size_t>(path);
        sum.numbers += LobeValue(fibre.attenuation[i] * density, fibre.share[i] * density).numbers;
    }
    sum.numbers *= LobeValue(lobe.weight, 1.0f).numbers;
    return sum;
}

std::optional<LobeDirection> sample_fibre(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& random) {
    const Fibre fibre(lobe, outgoing);
    int path = 0;
    float rest = random.x;
    while (path + 1 < kPaths && rest >= fibre.share[static_cast<size_t>(path)])
        rest -= fibre.share[static_cast<size_t>(path++)];
    constexpr float kMost = 1.0f - 6e-8f;
    const float share = fibre.share[static_cast<size_t>(path)];
    const float around = share > 0.0f ? std::min(rest / share, kMost) : 0.5f;
    // Of the residual the paths inside are sampled like one reflection (as it is evaluated).
    const float v = path == 0 ? lobe.roughness : variance_of(lobe, path);
    const SineCosine in = tilted(longitudinal_sample(fibre.out, v, random.z, random.y), -lobe.tilt, path);
    const float turn = fibre.turn_out + (path < 3 ? fibre.deviation(path) + TrimmedLogistic(lobe.alpha_y).sample(around)
                                                  : 2.0f * kPi * around);
    LobeDirection result{
        normalized_or(fibre.x * in.sine + (fibre.y * std::cos(turn) + fibre.z * std::sin(turn)) * in.cosine, outgoing)};
    result.through = path > 0;
    return result;
}

float roughness_factor(float radial_roughness) {
    const float x = radial_roughness;
    return ((((0.245f * x + 5.574f) * x - 10.73f) * x + 2.532f) * x - 0.215f) * x + 5.969f;
}

}  // namespace

float longitudinal_density(const SineCosine& in, const SineCosine& out, float v) {
    const float cosines = in.cosine * out.cosine / v, sines = in.sine * out.sine / v;
    if (v <= 0.1f) {
        constexpr float kLog2 = 0.69314718f;
        return std::exp(log_bessel(cosines) - sines - 1.0f / v + kLog2 + std::log(0.5f / v));
    }
    return std::exp(-sines + log_bessel(cosines)) / (std::sinh(1.0f / v) * 2.0f * v);
}

SineCosine longitudinal_sample(const SineCosine& in, float v, float u, float turn) {
    constexpr float kLeast = 1e-5f;
    const float share = std::max(u, kLeast);
    const float mean = 1.0f + v * std::log(share + (1.0f - share) * std::exp(-2.0f / v));
    const float sine =
        std::clamp(-mean * in.sine + cosine_of(mean) * std::cos(2.0f * kPi * turn) * in.cosine, -1.0f, 1.0f);
    return {sine, cosine_of(sine)};
}

LobeValue evaluate_fibre_lobe(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& incoming, Side side) {
    if (lobe.type == LobeType::HairFibre) return evaluate_fibre(lobe, outgoing, incoming);
    if ((lobe.type == LobeType::HairTransmission) != (side == Side::Transmitted)) return {};
    return evaluate_hair(lobe, outgoing, incoming);
}

std::optional<LobeDirection> sample_fibre_lobe(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& random) {
    return lobe.type == LobeType::HairFibre ? sample_fibre(lobe, outgoing, random)
                                            : sample_hair(lobe, outgoing, random);
}

Color fibre_albedo(const Lobe& lobe) {
    if (lobe.type != LobeType::HairFibre) return lobe.weight;
    const float factor = roughness_factor(lobe.alpha_x);
    const auto channel = [&](float absorption) { return std::exp(-std::sqrt(absorption) * factor); };
    return lobe.weight * Color(channel(lobe.fresnel_0.x), channel(lobe.fresnel_0.y), channel(lobe.fresnel_0.z));
}

float fibre_offset(const Vec3f& along, const Vec3f& outgoing, const Vec3f& normal) {
    const Vec3f y = normalized_or(along.cross(outgoing), Vec3f(0.0f));
    return std::clamp(normal.cross(along).dot(along.cross(y)), -1.0f, 1.0f);
}

Color absorption_of_color(const Color& color, float radial_roughness) {
    constexpr float kLeast = 1e-6f;  // blacker ones absorb all that single precision sees
    const float factor = roughness_factor(radial_roughness);
    Color result(0.0f);
    for (int c = 0; c < 3; ++c) {
        const float root = std::log(std::max(color[c], kLeast)) / factor;
        result[c] = root * root;
    }
    return result;
}

Color absorption_of_melanin(float melanin, float redness) {
    constexpr float kLeast = 1e-4f;  // as Cycles
    const float amount = -std::log(std::max(1.0f - melanin, kLeast));
    const Color eumelanin(0.506f, 0.841f, 1.653f), pheomelanin(0.343f, 0.733f, 1.924f);
    return eumelanin * (amount * (1.0f - redness)) + pheomelanin * (amount * redness);
}

float longitudinal_variance(float roughness) {
    const float root = 0.726f * roughness + 0.812f * roughness * roughness + 3.7f * power(roughness, 20);
    return root * root;
}

float azimuthal_scale(float roughness) {
    constexpr float kRootOfPiOver8 = 0.6266570687f;
    return (0.265f * roughness + 1.194f * roughness * roughness + 5.372f * power(roughness, 22)) * kRootOfPiOver8;
}

}  // namespace rayleaf
