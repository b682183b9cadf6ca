// Phase functions: how a participating medium spreads the light that it scatters over the angle by which it is turned.
//
// Henyey and Greenstein (Diffuse Radiation in the Galaxy, 1941): g > 0 scatters forwards, g < 0 backwards, 0 alike
// everywhere. Draine (Scattering by Interstellar Dust Grains, 2003, equation 4): theirs times 1 + alpha cosine²; with
// alpha 0 it is theirs, with g 0 and alpha 1 that of Rayleigh. Fournier and Forand (Computer-Based Underwater Imaging
// Analysis, 1999): of particles in water, by their index of refraction and the share that is scattered backwards.
// Mie's, of droplets, as the sum of the first two that Jendersie and d'Eon fit to it (An Approximate Mie Scattering
// Function for Fog and Cloud Rendering, 2023, with its supplement).
#pragma once

#include "base/vector.h"

#include <array>
#include <cmath>
#include <cstdint>

namespace rayleaf {

/// Henyey and Greenstein's phase function.
inline float henyey_greenstein(float cosine, float g) {
    const float around = 1.0f + g * g - 2.0f * g * cosine;
    return (1.0f - g * g) / (4.0f * kPi * around * std::sqrt(around));
}

/// A density of directions, per solid angle. A direction is the cosine of the angle between light before and after.
struct PhaseFunction {
    enum class Kind : uint8_t { Draine, FournierForand };

    Kind kind = Kind::Draine;
    float first =
        0;  ///< Draine: g of Henyey and Greenstein, within (-1, 1). Fournier and Forand: index of refraction, above 1
    float second =
        0;  ///< Draine: alpha, not below 0. Fournier and Forand: share turned by over a right angle, within (0, 1/2)

    bool operator==(const PhaseFunction&) const = default;

    float density(float cosine) const { return is_plain() ? henyey_greenstein(cosine, first) : shaped_density(cosine); }
    /// A cosine, distributed by the density; `random` in [0, 1).
    float sample(float random) const;

  private:
    bool is_plain() const { return kind == Kind::Draine && second == 0.0f; }
    float shaped_density(float cosine) const;
};

// Numbers that are not finite are as 0; those outside are moved to the next that makes no delta function.
PhaseFunction draine_phase(float g, float alpha);
PhaseFunction fournier_forand_phase(float ior, float backscatter);

struct PhaseShare {
    PhaseFunction phase;
    float share = 0;
};

/// Mie's, of water droplets of a diameter in micrometres.
std::array<PhaseShare, 2> mie_phase(float diameter);

}  // namespace rayleaf
