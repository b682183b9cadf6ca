// Which way walks below a surface turn: besides by the phase function, towards the surface, by which light has to
// leave, with distances to match (Krivanek and d'Eon 2014, "A zero-variance-based sampling scheme for Monte Carlo
// subsurface scattering"). In a body that is thin, towards either side.
//
// The body is taken for a slab across the normal of the place where light entered. Whatever its form is, all weights
// are exact: directions and distances of all techniques and channels are weighed together by the balance heuristic.
#pragma once

#include "shading/subsurface.h"

#include <limits>

namespace rayleaf {

/// A medium, and how it dims light that spreads in it.
class GuidedMedium {
  public:
    explicit GuidedMedium(const SubsurfaceMedium& medium);

    const SubsurfaceMedium& medium() const { return medium_; }
    /// The share of steps that are guided: few where light keeps its direction.
    float guided() const { return guided_; }
    /// Over which light dims by a factor of e, of the channel where that is longest; world units.
    float diffusion_length() const { return diffusion_length_; }
    /// Per mean free path, by channel, within (0, 1).
    const Color& decay() const { return decay_; }

    /// The cosine to the way out, for `random` in [0, 1).
    float sample_cosine(int channel, float random) const;
    /// Per solid angle.
    float density(int channel, float cosine) const;

  private:
    SubsurfaceMedium medium_;
    Color decay_, spread_;  ///< the latter: the inverse hyperbolic tangent of the former
    float guided_, diffusion_length_;
};

/// A turn and the distance up to the next.
struct GuidedStep {
    Vec3f direction;
    float length = 0;
};

/// Numbers in [0, 1) for one of them.
struct StepNumbers {
    Vec2f distance, direction;
    float technique = 0;
};

class SubsurfaceGuide {
  public:
    /// `normal`: outwards, at the place where light entered.
    explicit SubsurfaceGuide(const Vec3f& normal) : normal_(normal) {}
    /// Of the body there, world units; until it is told there is no other side.
    void set_thickness(double thickness) { thickness_ = thickness; }

    /// How far light goes in the direction by which it entered.
    float begin(const GuidedMedium& guided, const Color& shares, const Vec2f& distance);
    /// From a point `depth` below the surface, for light that came along `before`. `shares`: of the channels.
    GuidedStep sample(const GuidedMedium& guided, double depth, const Vec3f& before, const Color& shares,
                      const StepNumbers& random);
    /// What is left of light that was not scattered before the surface, `length` away, over its probability; of all
    /// that the last step's turn and distance stand for.
    Color at_surface(float length) const;
    /// Of light that was scattered at the end of the last step, over its density.
    Color scattered() const;

  private:
    Vec3f normal_;
    double thickness_ = std::numeric_limits<double>::infinity();

    // Of the last step.
    const GuidedMedium* guided_ = nullptr;
    Color shares_{0, 0, 0};
    float length_ = 0;
    float phase_ = 0;   ///< density of its direction by the phase function
    float cosine_ = 0;  ///< to the way out
    float guided_share_ = 0;
    float towards_far_ = 0;  ///< probability of the other side

    template <typename AtDistance>
    float density(const AtDistance& at_distance) const;
};

}  // namespace rayleaf
