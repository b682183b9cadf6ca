#include "integrators/medium_glow.h"

#include <cmath>

namespace rayleaf {
namespace {

/// Of the directions chosen so where nothing dims the lamps.
constexpr double kMostByGlow = 0.5;
/// Sine of the angle to a lamp, below which the density grows no more.
constexpr float kLeastSine = 1e-6f;

/// Per solid angle, of directions whose angle to a lamp is pi (1 - sqrt(random)).
float density_around(const Vec3f& lamp, const Vec3f& direction) {
    const float cosine = lamp.dot(direction), sine = lamp.cross(direction).length();
    const float rest = std::atan2(sine, -cosine);
    return rest / (kPi * kPi * kPi * std::max(sine, kLeastSine));
}

}  // namespace

LampGlow::LampGlow(const PassedLights& lights, const Vec3d& position, float extinction) {
    double bright = 0.0, dimmed = 0.0;
    std::array<double, PassedLights::kMost> glows;
    for (const PassedLight& light : lights.all()) {
        const Vec3d way = light.center - position;
        const double distance = std::max(way.length(), light.radius);
        if (!(distance > 0.0)) continue;
        const double glow = light.intensity / distance, seen = glow * std::exp(-double{extinction} * distance);
        bright += glow;
        dimmed += seen;
        glows[count_] = seen;
        lamps_[count_++].direction = Vec3f(normalized_or(way, Vec3d(0, 0, 1)));
    }
    if (!(bright > 0.0) || !std::isfinite(bright)) {
        count_ = 0;
        return;
    }
    for (size_t i = 0; i < count_; ++i) {
        lamps_[i].share = static_cast<float>(kMostByGlow * glows[i] / bright);
        share_ += lamps_[i].share;
    }
}

Vec3f LampGlow::direction(const Vec2f& random, float choice) const {
    size_t chosen = 0;
    while (chosen + 1 < count_ && choice >= lamps_[chosen].share) choice -= lamps_[chosen++].share;
    const Vec3f& axis = lamps_[chosen].direction;
    const float angle = kPi * (1.0f - std::sqrt(random.x)), around = 2.0f * kPi * random.y;
    Vec3f tangent, bitangent;
    orthonormal_basis(axis, tangent, bitangent);
    const float sine = std::sin(angle);
    return axis * std::cos(angle) + tangent * (sine * std::cos(around)) + bitangent * (sine * std::sin(around));
}

float LampGlow::density(const Vec3f& direction) const {
    float sum = 0.0f;
    for (size_t i = 0; i < count_; ++i) sum += lamps_[i].share * density_around(lamps_[i].direction, direction);
    return sum;
}

std::optional<PhaseSample> LampGlow::sample(const MediumClosures& medium, const Vec3f& outgoing,
                                            const Vec3f& random) const {
    std::optional<PhaseSample> result;
    if (random.z < share_) {
        if (!medium.scatters()) return std::nullopt;
        result.emplace();
        result->direction = direction({random.x, random.y}, random.z);
        result->density = medium.density(outgoing, result->direction);
    } else {
        result = medium.sample(outgoing, {random.x, random.y, (random.z - share_) / (1.0f - share_)});
        if (!result || !(share_ > 0.0f)) return result;
    }
    const float together = (1.0f - share_) * result->density + this->density(result->direction);
    if (!(together > 0.0f) || !std::isfinite(together)) return std::nullopt;
    result->weight = medium.evaluate(outgoing, result->direction) / together;
    return result;
}

}  // namespace rayleaf
