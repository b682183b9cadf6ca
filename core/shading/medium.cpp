#include "shading/medium.h"

namespace rayleaf {
namespace {

/// What is denser than this per world unit is opaque at any scale at which anything is seen.
constexpr float kLargestCoefficient = 1e10f;

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

}  // namespace

void MediumClosures::add_scattering(const Color& scattering, const PhaseFunction& phase) {
    const Color clean = sound(scattering);
    if (is_black(clean)) return;
    int place = 0;
    while (place < count && phases[static_cast<size_t>(place)].phase != phase) ++place;
    place = std::min(place, kMostPhases - 1);
    if (place == count) phases[static_cast<size_t>(count++)] = {Color(0.0f), phase};
    phases[static_cast<size_t>(place)].scattering += clean;
}

void MediumClosures::add_extinction(const Color& more) {
    extinction += sound(more);
}

void MediumClosures::add(const MediumClosures& other) {
    extinction += other.extinction;
    for (int i = 0; i < other.count; ++i)
        add_scattering(other.phases[static_cast<size_t>(i)].scattering, other.phases[static_cast<size_t>(i)].phase);
}

void MediumClosures::scale(float factor) {
    extinction *= factor;
    for (int i = 0; i < count; ++i) phases[static_cast<size_t>(i)].scattering *= factor;
}

Color MediumClosures::evaluate(const Vec3f& outgoing, const Vec3f& incoming) const {
    const float cosine = -outgoing.dot(incoming);
    Color sum(0.0f);
    for (int i = 0; i < count; ++i)
        sum += phases[static_cast<size_t>(i)].scattering * phases[static_cast<size_t>(i)].phase.density(cosine);
    return sum;
}

float MediumClosures::density(const Vec3f& outgoing, const Vec3f& incoming) const {
    const float total = total_weight(*this), cosine = -outgoing.dot(incoming);
    float sum = 0.0f;
    for (int i = 0; i < count; ++i)
        sum += weight_of(phases[static_cast<size_t>(i)]) * phases[static_cast<size_t>(i)].phase.density(cosine);
    return total > 0.0f ? sum / total : 0.0f;
}

std::optional<PhaseSample> MediumClosures::sample(const Vec3f& outgoing, const Vec3f& random) const {
    if (count == 0) return std::nullopt;
    float choice = random.z * total_weight(*this);
    int chosen = 0;
    while (chosen + 1 < count && choice >= weight_of(phases[static_cast<size_t>(chosen)]))
        choice -= weight_of(phases[static_cast<size_t>(chosen++)]);
    const float cosine = phases[static_cast<size_t>(chosen)].phase.sample(random.x);
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
