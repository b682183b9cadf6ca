#include "shading/medium.h"

namespace rayleaf {
namespace {

/// What is denser than this per world unit is opaque at any scale at which anything is seen.
constexpr float kLargestCoefficient = 1e10f;
/// Cycles' limit: nearer to 1 the function is a delta.
constexpr float kLargestG = 0.999f;
/// Below this, sampling is uniform to single precision.
constexpr float kLeastG = 1e-3f;

float sound(float x) {
    return x > 0.0f ? std::min(x, kLargestCoefficient) : 0.0f;
}

Color sound(const Color& c) {
    return {sound(c.x), sound(c.y), sound(c.z)};
}

float weight_of(const PhaseLobe& lobe) {
    return lobe.scattering.x + lobe.scattering.y + lobe.scattering.z;
}

float total_weight(const MediumClosures& medium) {
    float sum = 0.0f;
    for (int i = 0; i < medium.count; ++i) sum += weight_of(medium.phases[static_cast<size_t>(i)]);
    return sum;
}

/// Cosine of the angle between light before and after, distributed by the phase function.
float sampled_cosine(float g, float random) {
    if (std::abs(g) < kLeastG) return 1.0f - 2.0f * random;
    const float k = (1.0f - g * g) / (1.0f - g + 2.0f * g * random);
    return std::clamp((1.0f + g * g - k * k) / (2.0f * g), -1.0f, 1.0f);
}

}  // namespace

float henyey_greenstein(float cosine, float g) {
    const float around = 1.0f + g * g - 2.0f * g * cosine;
    return (1.0f - g * g) / (4.0f * kPi * around * std::sqrt(around));
}

void MediumClosures::add_scattering(const Color& scattering, float g) {
    const Color clean = sound(scattering);
    if (is_black(clean)) return;
    const float limited = std::isfinite(g) ? std::clamp(g, -kLargestG, kLargestG) : 0.0f;
    int place = 0;
    while (place < count && phases[static_cast<size_t>(place)].g != limited) ++place;
    place = std::min(place, kMostPhases - 1);
    if (place == count) phases[static_cast<size_t>(count++)] = {Color(0.0f), limited};
    phases[static_cast<size_t>(place)].scattering += clean;
}

void MediumClosures::add_extinction(const Color& more) {
    extinction += sound(more);
}

void MediumClosures::add(const MediumClosures& other) {
    extinction += other.extinction;
    for (int i = 0; i < other.count; ++i)
        add_scattering(other.phases[static_cast<size_t>(i)].scattering, other.phases[static_cast<size_t>(i)].g);
}

void MediumClosures::scale(float factor) {
    extinction *= factor;
    for (int i = 0; i < count; ++i) phases[static_cast<size_t>(i)].scattering *= factor;
}

Color MediumClosures::evaluate(const Vec3f& outgoing, const Vec3f& incoming) const {
    const float cosine = -outgoing.dot(incoming);
    Color sum(0.0f);
    for (int i = 0; i < count; ++i)
        sum += phases[static_cast<size_t>(i)].scattering * henyey_greenstein(cosine, phases[static_cast<size_t>(i)].g);
    return sum;
}

float MediumClosures::density(const Vec3f& outgoing, const Vec3f& incoming) const {
    const float total = total_weight(*this), cosine = -outgoing.dot(incoming);
    float sum = 0.0f;
    for (int i = 0; i < count; ++i)
        sum += weight_of(phases[static_cast<size_t>(i)]) * henyey_greenstein(cosine, phases[static_cast<size_t>(i)].g);
    return total > 0.0f ? sum / total : 0.0f;
}

std::optional<PhaseSample> MediumClosures::sample(const Vec3f& outgoing, const Vec3f& random) const {
    if (count == 0) return std::nullopt;
    float choice = random.z * total_weight(*this);
    int chosen = 0;
    while (chosen + 1 < count && choice >= weight_of(phases[static_cast<size_t>(chosen)]))
        choice -= weight_of(phases[static_cast<size_t>(chosen++)]);
    const float cosine = sampled_cosine(phases[static_cast<size_t>(chosen)].g, random.x);
    const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)), angle = 2.0f * kPi * random.y;
    const Vec3f forwards = -outgoing;
    Vec3f tangent, bitangent;
    orthonormal_basis(forwards, tangent, bitangent);
    PhaseSample result;
    result.direction = forwards * cosine + tangent * (sine * std::cos(angle)) + bitangent * (sine * std::sin(angle));
    result.density = density(outgoing, result.direction);
    if (!(result.density > 0.0f) || !std::isfinite(result.density)) return std::nullopt;
    result.weight = evaluate(outgoing, result.direction) / result.density;
    return result;
}

}  // namespace rayleaf
