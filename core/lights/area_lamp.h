// Area lamps: a parallelogram or an ellipse that shines to one side.
//
// A lamp of P watts and area A has the radiance P / (4 A) (measured in Cycles). A spread below 180 degrees acts like a
// grid of slats: it dims with the tangent of the angle to the normal, and the total power stays.
#pragma once

#include "lights/lamp_sample.h"
#include "lights/light.h"
#include "lights/light_tree.h"
#include "lights/lit_cone.h"
#include "lights/spherical_rectangle.h"

namespace rayleaf {

class AreaLamp {
  public:
    explicit AreaLamp(const Lamp& lamp);

    Maybe<LightSample> sample(const Vec3d& position, const Vec2f& random) const;
    /// Nearer than `end` along the ray.
    std::optional<LampIntersection> hit(const Ray& ray, double end, const Vec3d& from) const;

    /// False where `hit` finds nothing, wherever light sampling stands.
    bool may_be_met(const Ray& ray, double end) const;

    bool has_size() const { return area_ > 0; }
    Box3d bounds() const;
    double intensity() const;  ///< along the normal, W/sr, as one number
    LightCone cone() const { return {Vec3f(normal_), 1.0f, true, false}; }
    /// Whether it shines on a part of space alone.
    static bool is_bounded() { return true; }
    /// False where no light of the lamp arrives.
    bool reaches(const Vec3d& position) const { return (position - center_).dot(normal_) > 0; }
    LitCone lit() const { return {center_, normal_, 0.0}; }

  private:
    Vec3d center_;
    Vec3d x_, y_;                 ///< half edges, or half axes of the ellipse
    double x_length_, y_length_;  ///< of these
    Vec3d along_x_, along_y_;     ///< of an offset in the lamp's plane, its product with these is in units of those
    Vec3d normal_;                ///< unit, the way the lamp shines
    double unit_area_;            ///< of the parallelogram of the half edges
    double area_;                 ///< 0: a delta light with a cosine
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
    /// A point that the lamp shines on.
    struct Place {
        Vec3d position;
        Vec3d offset;       ///< from the lamp's centre
        double height = 0;  ///< above the lamp
    };
    /// Empty where the point is not above the lamp.
    std::optional<Place> place(const Vec3d& position) const;
    std::optional<Window> window(const Place& at) const;
    float attenuation(double cosine) const;
    void sample_point(const Place& at, Maybe<LightSample>& result) const;
    void sample_within(const Place& at, const Window& window, const Vec2f& random, Maybe<LightSample>& result) const;
    void sample_by_area(const Place& at, const Window& window, const Vec2f& random, Maybe<LightSample>& result) const;
    /// All but the density of a sample that is `way` from the point; returns the distance.
    double set_towards(const Place& at, const Vec3d& way, Maybe<LightSample>& result) const;
    /// Density, per solid angle, towards the point of the lamp at `to`.
    double density(const Vec3d& position, const Vec3d& to) const;
    double density_by_area(const Place& at, const Window& window, double distance) const;
    /// An ellipse is sampled as a whole unless its window is the smaller of the two.
    bool samples_whole_ellipse(const Window& window) const;
    SphericalRectangle spherical(const Place& at, const Window& window) const;
};

inline bool AreaLamp::may_be_met(const Ray& ray, double end) const {
    // Lengths are times the cosine, so that nothing is divided.
    const double cosine = -ray.direction.dot(normal_);
    if (!(cosine > 0)) return false;
    const Vec3d from = ray.origin - center_;
    const double height = from.dot(normal_);
    if (!(height > ray.t_min * cosine && height < end * cosine)) return false;
    const Vec3d offset = from * cosine + ray.direction * height;
    const double x = offset.dot(along_x_), y = offset.dot(along_y_);
    return ellipse_ ? x * x + y * y <= cosine * cosine : std::abs(x) <= cosine && std::abs(y) <= cosine;
}

}  // namespace rayleaf
