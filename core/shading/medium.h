// What a participating medium does to light at a point.
//
// Directions are unit, world space; `incoming` and `outgoing` both point away from the place of scattering, towards the
// light and towards the viewer.
#pragma once

#include "base/vector.h"
#include "shading/phase.h"

#include <array>
#include <optional>

namespace rayleaf {

struct PhaseLobe {
    Color scattering{0, 0, 0};  ///< per world unit
    PhaseFunction phase;
};

/// A sampled direction.
struct PhaseSample {
    Vec3f direction{0, 0, 1};  ///< towards the light
    Color weight{0, 0, 0};     ///< scattering times phase function / density, per world unit
    float density = 0;         ///< per solid angle
};

/// The medium part of a point's closures.
struct MediumClosures {
    static constexpr int kMostPhases = 8;

    Color extinction{0, 0, 0};  ///< absorption and scattering together, per world unit
    std::array<PhaseLobe, kMostPhases> phases;
    int count = 0;

    void clear() {
        extinction = Color(0.0f);
        count = 0;
    }
    bool scatters() const { return count > 0; }
    /// Numbers that are not finite or negative become 0. Past kMostPhases the last takes the rest.
    void add_scattering(const Color& scattering, const PhaseFunction& phase);
    void add_extinction(const Color& more);
    void scale(float factor);
    /// All that another medium at the same place does.
    void add(const MediumClosures& other);
    /// Sum over the phase functions of scattering times phase function, per world unit and solid angle.
    Color evaluate(const Vec3f& outgoing, const Vec3f& incoming) const;
    /// With which `sample` chooses `incoming`, per solid angle.
    float density(const Vec3f& outgoing, const Vec3f& incoming) const;
    /// `random` in [0,1)³, z chooses the phase function. Empty where nothing scatters.
    std::optional<PhaseSample> sample(const Vec3f& outgoing, const Vec3f& random) const;
};

}  // namespace rayleaf
