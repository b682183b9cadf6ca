#include "integrators/subsurface_guide.h"

#include "integrators/medium_weights.h"
#include "shading/phase.h"

#include <algorithm>
#include <cmath>

namespace rayleaf {
namespace {

constexpr float kGuided = 0.8f;
constexpr float kStraight = 1e-3f;

/// Henyey and Greenstein's phase function: the cosine to the old direction.
float phase_cosine(float g, float random) {
    if (std::abs(g) < kStraight) return 1.0f - 2.0f * random;
    const float k = (1.0f - g * g) / (1.0f - g + 2.0f * g * random);
    return std::clamp((1.0f + g * g - k * k) / (2.0f * g), -1.0f, 1.0f);
}

Vec3f turned(const Vec3f& direction, float cosine, float turn) {
    Vec3f across, up;
    orthonormal_basis(direction, across, up);
    const float sine = std::sqrt(std::max(1.0f - cosine * cosine, 0.0f)), angle = 2.0f * kPi * turn;
    return (across * std::cos(angle) + up * std::sin(angle)) * sine + direction * cosine;
}

float length_of(float extinction, float random) {
    constexpr float kLeast = 1e-7f;
    return -std::log(std::max(1.0f - random, kLeast)) / extinction;
}

/// The inverse of the diffusion length in mean free paths, x in albedo atanh(x) = x: a fit, good to 1e-4. Any other
/// would only make more noise.
float decay_of(float albedo) {
    constexpr float kLeast = 1e-3f, kMost = 0.9999f;
    if (!(albedo > 0.0f)) return kMost;
    const float exponent = 2.44294f - 0.0215813f * albedo + 0.578637f / albedo;
    return std::clamp(std::sqrt(std::max(1.0f - std::pow(albedo, exponent), 0.0f)), kLeast, kMost);
}

}  // namespace

GuidedMedium::GuidedMedium(const SubsurfaceMedium& medium) : medium_(medium), diffusion_length_(0.0f) {
    for (int c = 0; c < 3; ++c) {
        decay_[c] = decay_of(medium.albedo[c]);
        spread_[c] = std::atanh(decay_[c]);
        diffusion_length_ = std::max(diffusion_length_, 1.0f / (medium.extinction[c] * decay_[c]));
    }
    guided_ = kGuided * (1.0f - std::pow(std::abs(medium.anisotropy), 0.125f));
}

float GuidedMedium::sample_cosine(int channel, float random) const {
    const float decay = decay_[channel];
    const float cosine = (1.0f - (1.0f + decay) * std::exp(-2.0f * spread_[channel] * random)) / decay;
    return std::clamp(cosine, -1.0f, 1.0f);
}

float GuidedMedium::density(int channel, float cosine) const {
    const float decay = decay_[channel];
    return decay / (4.0f * kPi * spread_[channel] * (1.0f - decay * cosine));
}

float SubsurfaceGuide::begin(const GuidedMedium& guided, const Color& shares, const Vec2f& distance) {
    guided_ = &guided;
    shares_ = shares;
    guided_share_ = 0.0f;
    phase_ = 1.0f;
    const int channel = channel_of(shares, distance.x);
    return length_ = length_of(guided.medium().extinction[channel], distance.y);
}

GuidedStep SubsurfaceGuide::sample(const GuidedMedium& guided, double depth, const Vec3f& before, const Color& shares,
                                   const StepNumbers& random) {
    guided_ = &guided;
    shares_ = shares;
    guided_share_ = guided.guided();
    const SubsurfaceMedium& medium = guided.medium();
    const int channel = channel_of(shares, random.distance.x);
    towards_far_ = 0.0f;
    if (std::isfinite(thickness_)) {
        const double from_middle = thickness_ - 2.0 * std::clamp(depth, 0.0, thickness_);
        const double lengths = from_middle / static_cast<double>(guided.diffusion_length());
        towards_far_ = static_cast<float>(1.0 / (1.0 + std::exp(std::clamp(lengths, -50.0, 50.0))));
    }
    float stretch = 1.0f;
    GuidedStep step;
    if (random.technique >= guided.guided()) {
        step.direction = turned(before, phase_cosine(medium.anisotropy, random.direction.x), random.direction.y);
        cosine_ = step.direction.dot(normal_);
    } else {
        const bool is_far = random.technique < guided.guided() * towards_far_;
        const float cosine = guided.sample_cosine(channel, random.direction.x);
        stretch = 1.0f - guided.decay()[channel] * cosine;
        cosine_ = is_far ? -cosine : cosine;
        step.direction = turned(normal_, cosine_, random.direction.y);
    }
    phase_ = henyey_greenstein(before.dot(step.direction), medium.anisotropy);
    length_ = step.length = length_of(medium.extinction[channel] * stretch, random.distance.y);
    return step;
}

/// Of turn and distance; `at_distance(extinction)`: of the latter.
template <typename AtDistance>
float SubsurfaceGuide::density(const AtDistance& at_distance) const {
    const float guided = guided_share_;
    float sum = 0.0f;
    for (int c = 0; c < 3; ++c) {
        if (!(shares_[c] > 0.0f)) continue;
        const float extinction = guided_->medium().extinction[c], bend = guided_->decay()[c] * cosine_;
        float own = (1.0f - guided) * phase_ * at_distance(extinction);
        if (guided > 0.0f) {
            own +=
                guided * (1.0f - towards_far_) * guided_->density(c, cosine_) * at_distance(extinction * (1.0f - bend));
            if (towards_far_ > 0.0f)
                own += guided * towards_far_ * guided_->density(c, -cosine_) * at_distance(extinction * (1.0f + bend));
        }
        sum += shares_[c] * own;
    }
    return sum;
}

Color SubsurfaceGuide::at_surface(float length) const {
    const float density = this->density([length](float extinction) { return std::exp(-extinction * length); });
    if (!(density > 0.0f)) return Color(0.0f);
    Color left;
    for (int c = 0; c < 3; ++c) left[c] = std::exp(-guided_->medium().extinction[c] * length);
    return left * (phase_ / density);
}

Color SubsurfaceGuide::scattered() const {
    const float length = length_;
    const float density =
        this->density([length](float extinction) { return extinction * std::exp(-extinction * length); });
    if (!(density > 0.0f)) return Color(0.0f);
    const SubsurfaceMedium& medium = guided_->medium();
    Color left;
    for (int c = 0; c < 3; ++c)
        left[c] = medium.albedo[c] * medium.extinction[c] * std::exp(-medium.extinction[c] * length);
    return left * (phase_ / density);
}

}  // namespace rayleaf
