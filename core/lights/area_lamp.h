// Area lamps: a parallelogram or an ellipse that shines to one side.
//
// A lamp of P watts and area A has the radiance P / (4 A) (measured in Cycles). A spread below 180 degrees acts like a
// grid of slats: it dims with the tangent of the angle to the normal, and the total power stays.
#pragma once

#include "lights/lamp_sample.h"
#include "lights/light.h"
#include "lights/light_tree.h"
#include "lights/lit_cone.h"

namespace rayleaf {

class AreaLamp {
  public:
    explicit AreaLamp(const Lamp& lamp);

    std::optional<LampSample> sample(const Vec3d& position, const Vec2f& random) const;
    std::optional<LampIntersection> hit(const Ray& ray, const Vec3d& from) const;

    bool has_size() const { return area_ > 0; }
    Box3d bounds() const;
    double intensity() const;  ///< along the normal, W/sr, as one number
    LightCone cone() const { return {Vec3f(normal_), 1.0f, true, false}; }
    /// False where no light of the lamp arrives.
    bool reaches(const Vec3d& position) const { return lit().holds(position); }
    LitCone lit() const { return {center_, normal_, 0.0}; }

  private:
    Vec3d center_;
    Vec3d x_, y_;   ///< half edges, or half axes of the ellipse
    Vec3d normal_;  ///< unit, the way the lamp shines
    double area_;   ///< 0: a delta light with a cosine
    Color radiance_{0, 0, 0};
    Color intensity_;  ///< along the normal, W/sr
    bool ellipse_;
    bool orthogonal_;        ///< the half edges are at right angles
    double cot_spread_ = 0;  ///< of half the spread; 0: a full hemisphere
    double gain_ = 1;        ///< keeps the power whatever the spread

    /// Part of the lamp that a point can see through the slats, in units of the half edges.
    struct Window {
        double x_min, x_max, y_min, y_max;
    };
    std::optional<Window> window(const Vec3d& position) const;
    float attenuation(double cosine) const;
    std::optional<LampSample> sample_by_area(const Vec3d& position, const Vec2f& random, const Window& window) const;
    /// Density, per solid angle, towards the point of the lamp at `to`.
    double density(const Vec3d& position, const Vec3d& to) const;
};

}  // namespace rayleaf
