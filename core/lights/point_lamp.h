// Point and spot lamps: a sphere that shines alike everywhere, or a point; a spot lets light out in a cone only.
//
// A lamp of P watts has the intensity P / (4 pi) W/sr whatever its radius, so its sphere has the radiance
// P / (4 pi² r²), as in Cycles. (Cycles 3.4 replaces the sphere by a disk that faces the point; the sphere keeps the
// inverse square law exact.)
#pragma once

#include "lights/lamp_sample.h"
#include "lights/light.h"

namespace rayleaf {

class PointLamp {
  public:
    explicit PointLamp(const Lamp& lamp);

    std::optional<LampSample> sample(const Vec3d& position, const Vec2f& random) const;
    /// Whether the line from `origin` meets the sphere in (t_min, t_max). `from` is where light sampling would have
    /// stood: it decides whether the sphere is seen from outside or from inside.
    std::optional<LampIntersection> hit(const Ray& ray, const Vec3d& from) const;

    bool has_size() const { return radius_ > 0; }
    Box3d bounds() const;
    /// Intensity, W/sr, as one number; for the choice of a light.
    double intensity() const { return max_abs(intensity_); }
    /// False where no light of the lamp arrives.
    bool reaches(const Vec3d& position) const;

  private:
    Vec3d center_;
    double radius_;    ///< 0: a point
    Color intensity_;  ///< W/sr
    Color radiance_;   ///< of the sphere
    Vec3d axis_;       ///< unit, the way a spot shines
    bool spot_;
    SpotProfile profile_;
    double cos_half_ = 0;    ///< of the cone
    double fade_width_ = 0;  ///< in cosines; 0: a sharp border

    double density(const Vec3d& position) const;
    float attenuation(const Vec3d& towards_lamp) const;
};

}  // namespace rayleaf
