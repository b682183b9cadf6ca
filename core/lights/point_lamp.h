// Point and spot lamps: a sphere that shines alike everywhere, or a point; a spot lets light out in a cone only.
//
// A lamp of P watts has the intensity P / (4 pi) W/sr whatever its radius, so its sphere has the radiance
// P / (4 pi² r²), as in Cycles. The sphere keeps the inverse square law exact. With soft falloff, a disk of the same
// radiance takes its place, that faces whoever looks: near the lamp it brings less light, and nobody is inside of it.
// Either is a cone of directions, in which directions are sampled evenly.
#pragma once

#include "lights/lamp_sample.h"
#include "lights/light.h"
#include "lights/light_tree.h"
#include "lights/lit_cone.h"

namespace rayleaf {

class PointLamp {
  public:
    explicit PointLamp(const Lamp& lamp);

    Maybe<LightSample> sample(const Vec3d& position, const Vec2f& random) const;
    /// Whether the ray meets the sphere or the disk in (t_min, end). `from` is where light sampling would have stood:
    /// the disk faces it, and it decides whether the sphere is seen from outside or from inside.
    std::optional<LampIntersection> hit(const Ray& ray, double end, const Vec3d& from) const;

    /// False where `hit` finds nothing, wherever light sampling stands.
    bool may_be_met(const Ray& ray, double end) const;

    bool has_size() const { return radius_ > 0; }
    Box3d bounds() const;
    /// Intensity, W/sr, as one number; for the choice of a light.
    double intensity() const { return max_abs(intensity_); }
    static LightCone cone() { return {}; }
    /// Whether it shines on a part of space alone.
    bool is_bounded() const { return lit_.is_bounded(); }
    /// False where no light of the lamp arrives.
    bool reaches(const Vec3d& position) const { return lit_.holds(position); }
    const LitCone& lit() const { return lit_; }

  private:
    Vec3d center_;
    double radius_;    ///< 0: a point
    bool soft_;        ///< a disk
    Color intensity_;  ///< W/sr
    Color radiance_;   ///< of the sphere
    Vec3d axis_;       ///< unit, the way a spot shines
    bool spot_;
    SpotProfile profile_;
    double cos_half_ = 0;    ///< of the cone
    double fade_width_ = 0;  ///< in cosines; 0: a sharp border
    LitCone lit_;

    /// Square of the sine of the cone's half angle, at a distance; a sphere that is seen from inside: 1 or more.
    double sine_squared(double distance_squared) const;
    double density(const Vec3d& position) const;
    /// Its shell seen from within, all around.
    void sample_inside(const Vec3d& position, const Vec2f& random, LightSample& sample) const;
    void sample_outside(const Vec3d& position, const Vec2f& random, LightSample& sample) const;
    std::optional<double> distance_to_sphere(const Ray& ray, const Vec3d& from) const;
    std::optional<double> distance_to_disk(const Ray& ray, const Vec3d& from) const;
    float attenuation(const Vec3d& towards_lamp) const;
};

inline bool PointLamp::may_be_met(const Ray& ray, double end) const {
    const Vec3d offset = center_ - ray.origin;
    const double along = offset.dot(ray.direction);
    return along + radius_ > ray.t_min && along - radius_ < end &&
           (offset - ray.direction * along).length2() <= radius_ * radius_;
}

}  // namespace rayleaf
