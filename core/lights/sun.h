// The sun: light from one direction, or from a disk on the sky that shines alike everywhere.
//
// Its strength is the irradiance, W/m², that a surface facing a sun of no size receives; a wide sun's radiance is that
// over the solid angle of its disk.
#pragma once

#include "lights/cosines.h"
#include "lights/lamp_sample.h"
#include "lights/light.h"

namespace rayleaf {

class Sun {
  public:
    explicit Sun(const Lamp& lamp);

    Maybe<LightSample> sample(const Vec2f& random) const;
    /// By a ray that goes on to infinity.
    bool is_met(const Ray& ray) const;
    std::optional<LampIntersection> hit(const Ray& ray) const;

    bool has_size() const { return solid_angle_ > 0; }
    /// W/m² as one number; for the choice of a light.
    double irradiance() const { return max_abs(irradiance_); }
    /// As cosine_at_surface.
    double cosine(const Vec3f& normal) const { return cosine_at_surface(normal, axis_, half_angle_); }

  private:
    ConeFrame towards_;  ///< about the way from the scene to the sun
    Vec3f axis_;         ///< the same way
    Color irradiance_;
    Color radiance_{0, 0, 0};
    double one_minus_cosine_;  ///< of the disk's angular radius
    double sine_squared_;      ///< of the same
    HalfAngle half_angle_;     ///< the same
    double solid_angle_;       ///< 0: a delta light
    double density_ = 1;       ///< with which it is sampled
};

}  // namespace rayleaf
