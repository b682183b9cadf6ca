#include "shading/gabor.h"

#include "shading/lattice_hash.h"

#include <complex>

namespace rayleaf {
namespace {

constexpr int kWavesPerCell = 8;
constexpr float kLeastFrequency = 0.001f;  // as Cycles
constexpr float kRange = 6.0f;             // deviations that become 0..1
/// The mean of a weight's square times the mean of a wave's square over the phases.
constexpr float kSecondMoment = 0.5f;

/// What a wave of weight 1 adds at `offset` from its middle, whose way is `direction`.
std::complex<float> wave_at(const Vec3f& offset, float frequency, const Vec3f& direction) {
    const float distance2 = offset.length2();
    if (!(distance2 < 1.0f)) return 0.0f;
    const float hann = 0.5f + 0.5f * std::cos(kPi * distance2);
    return std::polar(std::exp(-kPi * distance2) * hann, 2.0f * kPi * frequency * offset.dot(direction));
}

/// The waves of the plane: their ways, and what chance gives the one of `number` in a cell.
class PlaneWaves {
  public:
    static constexpr int kDimensions = 2;

    explicit PlaneWaves(const GaborParameters& p, float isotropy) : angle_(p.orientation), spread_(kPi * isotropy) {}

    /// Of a wave's square, over the plane.
    static float integral() { return 0.25f; }
    Vec3f direction(const Vec3f& cell, float key) const {
        const float angle = angle_ + (unit_hash(cell.x, cell.y, key) - 0.5f) * spread_;
        return {std::cos(angle), std::sin(angle), 0.0f};
    }
    static Vec3f middle(const Vec3f& cell, float key) {
        return {unit_hash(cell.x, cell.y, key), unit_hash(key, cell.x, cell.y), 0.0f};
    }
    static float chance(const Vec3f& cell, float key) { return unit_hash(cell.x, cell.y, key); }

  private:
    float angle_, spread_;
};

/// The same of space.
class SpaceWaves {
  public:
    static constexpr int kDimensions = 3;

    SpaceWaves(const GaborParameters& p, float isotropy)
        : direction_(normalized_or(p.direction, Vec3f(0, 0, 1))), spread_(kPi * isotropy) {
        inclination_ = std::acos(std::clamp(direction_.z, -1.0f, 1.0f));
        azimuth_ = std::atan2(direction_.y, direction_.x);
    }

    static float integral() { return 1.0f / (4.0f * std::sqrt(2.0f)); }
    Vec3f direction(const Vec3f& cell, float key) const {
        if (spread_ == 0.0f) return direction_;
        const float inclination = inclination_ + spread_ * unit_hash(cell.x, cell.y, cell.z, key);
        const float azimuth = azimuth_ + spread_ * unit_hash(cell.z, cell.x, key, cell.y);
        const float sine = std::sin(inclination);
        return {sine * std::cos(azimuth), sine * std::sin(azimuth), std::cos(inclination)};
    }
    static Vec3f middle(const Vec3f& cell, float key) {
        return {unit_hash(cell.x, cell.y, cell.z, key), unit_hash(cell.z, cell.x, key, cell.y),
                unit_hash(key, cell.z, cell.y, cell.x)};
    }
    static float chance(const Vec3f& cell, float key) { return unit_hash(cell.x, cell.y, cell.z, key); }

  private:
    Vec3f direction_;
    float inclination_, azimuth_, spread_;
};

/// The waves of one cell at `place`, which is relative to it.
template <typename Waves>
std::complex<float> cell_sum(const Waves& waves, const Vec3f& cell, const Vec3f& place, float frequency) {
    constexpr int kKeys = 3;  // direction, middle, weight
    std::complex<float> sum = 0.0f;
    for (int i = 0; i < kWavesPerCell; ++i) {
        const auto key = static_cast<float>(i * kKeys);
        const Vec3f offset = place - Waves::middle(cell, key + 1.0f);
        if (offset.length2() >= 1.0f) continue;
        const std::complex<float> wave = wave_at(offset, frequency, waves.direction(cell, key));
        sum += Waves::chance(cell, key + 2.0f) < 0.5f ? -wave : wave;
    }
    return sum;
}

/// The cells around count, as waves reach no farther than the next one.
template <typename Waves>
GaborResult gabor(const Waves& waves, const Vec3f& point, float frequency) {
    const Vec3f cell(std::floor(point.x), std::floor(point.y), std::floor(point.z));
    const Vec3f place = point - cell;
    constexpr int kDepth = Waves::kDimensions == 3 ? 1 : 0;
    std::complex<float> sum = 0.0f;
    for (int z = -kDepth; z <= kDepth; ++z)
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x) {
                const Vec3f step(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
                sum += cell_sum(waves, cell + step, place - step, frequency);
            }
    const float range = kRange * std::sqrt(kWavesPerCell * kSecondMoment * Waves::integral());
    return {sum.imag() / range * 0.5f + 0.5f, (std::arg(sum) + kPi) / (2.0f * kPi), std::abs(sum) / range};
}

}  // namespace

GaborResult gabor_texture(int dimensions, const Vec3f& point, const GaborParameters& parameters) {
    const float frequency = std::max(parameters.frequency, kLeastFrequency);
    const float isotropy = 1.0f - std::clamp(parameters.anisotropy, 0.0f, 1.0f);
    if (dimensions == 3) return gabor(SpaceWaves(parameters, isotropy), point, frequency);
    return gabor(PlaneWaves(parameters, isotropy), Vec3f(point.x, point.y, 0.0f), frequency);
}

}  // namespace rayleaf
