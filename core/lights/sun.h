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

    LampSample sample(const Vec2f& random) const;
    /// By a ray that goes on to infinity.
    std::optional<LampIntersection> hit(const Ray& ray) const;

    bool has_size() const { return solid_angle_ > 0; }
    /// W/m² as one number; for the choice of a light.
    double irradiance() const { return max_abs(irradiance_); }
    /// As cosine_at_surface.
    double cosine(const Vec3f& normal) const { return cosine_at_surface(normal, Vec3f(towards_), half_angle_); }

  private:
    Vec3d towards_;  ///< unit, from the scene to the sun
    Color irradiance_;
    Color radiance_{0, 0, 0};
    double one_minus_cosine_;  ///< of the disk's angular radius
    double sine_squared_;      ///< of the same
    HalfAngle half_angle_;     ///< the same
    double solid_angle_;       ///< 0: a delta light
};

}  // namespace rayleaf
