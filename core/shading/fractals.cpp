#include "shading/fractals.h"

#include "shading/noise.h"
#include "shading/noise_lanes.h"

namespace rayleaf {
namespace {

/// Walks up the octaves: noise at a point whose frequency rises, and the amplitude that belongs to it. Where there are
/// several, the noise of all is computed together.
template <int N>
class Octaves {
  public:
    Octaves(const LatticePoint<N>& p, const FractalParameters& parameters)
        : p_(p), parameters_(parameters), whole_(static_cast<int>(parameters.octaves)) {
        const size_t count = static_cast<size_t>(whole_) + (rest() != 0.0f ? 1 : 0);
        if (count < NoisePoints::kLeast) return;
        LatticePoint<N> at = p;
        for (size_t i = 0; i < count; ++i, rise(at)) all_.add(at);
        all_.compute(N);
    }
    Octaves(const Octaves&) = delete;
    Octaves& operator=(const Octaves&) = delete;

    /// How many octaves count in full, and how much the one beyond them does.
    int whole() const { return whole_; }
    float rest() const { return parameters_.octaves - std::floor(parameters_.octaves); }
    float noise() const { return all_.count > 0 ? all_.noise[octave_] : signed_noise<N>(p_); }
    float amplitude() const { return amplitude_; }
    void next() {
        rise(p_);
        amplitude_ *= parameters_.amplitude;
        ++octave_;
    }

  private:
    LatticePoint<N> p_;
    const FractalParameters& parameters_;
    int whole_;
    float amplitude_ = 1.0f;
    size_t octave_ = 0;
    NoisePoints all_;  ///< of octaves; none: one by one

    void rise(LatticePoint<N>& p) const {
        for (float& x : p) x *= parameters_.lacunarity;
    }
};

template <int N>
float fbm(Octaves<N>& octaves) {
    float value = 0.0f;
    for (int i = 0; i < octaves.whole(); ++i, octaves.next()) value += octaves.noise() * octaves.amplitude();
    if (octaves.rest() != 0.0f) value += octaves.rest() * octaves.noise() * octaves.amplitude();
    return value;
}

template <int N>
float multifractal(Octaves<N>& octaves) {
    float value = 1.0f;
    for (int i = 0; i < octaves.whole(); ++i, octaves.next()) value *= octaves.amplitude() * octaves.noise() + 1.0f;
    if (octaves.rest() != 0.0f) value *= octaves.rest() * octaves.amplitude() * octaves.noise() + 1.0f;
    return value;
}

/// What is high already gets more of the finer octaves.
template <int N>
float hetero_terrain(Octaves<N>& octaves, float offset) {
    float value = offset + octaves.noise();
    octaves.next();
    const auto rise = [&] { return (octaves.noise() + offset) * octaves.amplitude() * value; };
    for (int i = 1; i < octaves.whole(); ++i, octaves.next()) value += rise();
    if (octaves.rest() != 0.0f) value += octaves.rest() * rise();
    return value;
}

template <int N>
float hybrid_multifractal(Octaves<N>& octaves, float offset, float gain) {
    constexpr float kLeastWeight = 0.001f;  // what follows cannot be seen
    float value = 0.0f, weight = 1.0f;
    const auto signal = [&] { return (octaves.noise() + offset) * octaves.amplitude(); };
    for (int i = 0; weight > kLeastWeight && i < octaves.whole(); ++i, octaves.next()) {
        weight = std::min(weight, 1.0f);
        const float octave = signal();
        value += weight * octave;
        weight *= gain * octave;
    }
    if (octaves.rest() != 0.0f && weight > kLeastWeight) value += octaves.rest() * std::min(weight, 1.0f) * signal();
    return value;
}

template <int N>
float ridged_multifractal(Octaves<N>& octaves, float offset, float gain) {
    const auto ridge = [&] {
        const float height = offset - std::abs(octaves.noise());
        return height * height;
    };
    float signal = ridge(), value = signal;
    octaves.next();
    for (int i = 1; i < octaves.whole(); ++i, octaves.next()) {
        signal = ridge() * std::clamp(signal * gain, 0.0f, 1.0f);
        value += signal * octaves.amplitude();
    }
    return value;
}

}  // namespace

template <int N>
float fractal(FractalType type, const LatticePoint<N>& p, const FractalParameters& parameters) {
    Octaves<N> octaves(p, parameters);
    switch (type) {
        case FractalType::FBM:
            return fbm(octaves);
        case FractalType::MULTIFRACTAL:
            return multifractal(octaves);
        case FractalType::HETERO_TERRAIN:
            return hetero_terrain(octaves, parameters.offset);
        case FractalType::HYBRID_MULTIFRACTAL:
            return hybrid_multifractal(octaves, parameters.offset, parameters.gain);
        case FractalType::RIDGED_MULTIFRACTAL:
            return ridged_multifractal(octaves, parameters.offset, parameters.gain);
    }
    return 0.0f;
}

template float fractal<1>(FractalType, const LatticePoint<1>&, const FractalParameters&);
template float fractal<2>(FractalType, const LatticePoint<2>&, const FractalParameters&);
template float fractal<3>(FractalType, const LatticePoint<3>&, const FractalParameters&);
template float fractal<4>(FractalType, const LatticePoint<4>&, const FractalParameters&);

float musgrave_texture(int dimensions, FractalType type, const Vec4f& point, float detail, float dimension,
                       FractalParameters parameters) {
    constexpr float kLeast = 1e-5f;  // as Cycles
    parameters.octaves = detail > 0.0f ? std::min(detail, kMostOctaves) : 0.0f;
    parameters.lacunarity = std::fmax(parameters.lacunarity, kLeast);
    parameters.amplitude = std::pow(parameters.lacunarity, -std::fmax(dimension, kLeast));
    switch (dimensions) {
        case 1:
            return fractal<1>(type, {point.w}, parameters);
        case 2:
            return fractal<2>(type, {point.x, point.y}, parameters);
        case 3:
            return fractal<3>(type, {point.x, point.y, point.z}, parameters);
        default:
            return fractal<4>(type, {point.x, point.y, point.z, point.w}, parameters);
    }
}

}  // namespace rayleaf
