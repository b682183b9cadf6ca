// Where to media scatter light that is scattered once more: around lamps they glow.
//
// In a thin medium that is the same everywhere, the light of a lamp that is scattered once into a ray that goes on for
// ever grows with (pi - a) / sin(a), a the angle between the ray and the way to the lamp. So some of the directions are
// chosen, the others by the phase function; all are weighed by the balance heuristic.
#pragma once

#include "lights/light.h"
#include "shading/medium.h"

namespace rayleaf {

class LampGlow {
  public:
    /// Of lights seen from a point of a medium; `extinction` there, of its densest channel.
    LampGlow(const PassedLights& lights, const Vec3d& position, float extinction);

    /// A direction, with the weight that it has by both techniques, and the density that it has by the phase function
    /// alone. `random` in [0,1)³, z chooses the technique.
    std::optional<PhaseSample> sample(const MediumClosures& medium, const Vec3f& outgoing, const Vec3f& random) const;

  private:
    struct Lamp {
        Vec3f direction;
        float share;  ///< of the directions
    };
    std::array<Lamp, PassedLights::kMost> lamps_;
    size_t count_ = 0;
    float share_ = 0;  ///< of all lamps together

    Vec3f direction(const Vec2f& random, float choice) const;
    float density(const Vec3f& direction) const;
};

}  // namespace rayleaf
