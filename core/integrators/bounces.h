// What a path has gone through: its bounces by kind against Blender's limits, and what the Light Path node may ask.
#pragma once

#include "integrators/path.h"
#include "shading/closures.h"
#include "shading/inputs.h"
#include "trace/tracer.h"

#include <limits>

namespace rayleaf {

/// Vertices of one path, borders of media included: none gets stuck.
constexpr int kMostVertices = 4096;

class Bounces {
  public:
    explicit Bounces(const PathSettings& settings) : settings_(settings) {}

    /// After a scattering.
    void scatter(const LobeSample& sample);
    /// After a scattering by a medium, with this density per solid angle.
    void scatter_in_medium(float density);
    /// After going straight on, `length` along, where nothing but a medium begins or ends.
    void pass_boundary(double length) { passed_ += length; }
    /// After going straight on through a transparent surface `length` away.
    void pass_through(double length);
    /// After a portal `length` away, which counts as a transparent surface.
    void pass_portal(double length) {
        pass_through(length);
        ++state_.portal_depth;
    }
    /// One transparent surface more than allowed was passed: what the ray meets may emit, and that is all. (So a limit
    /// of n lets the camera see the world behind n + 1 surfaces, as in Cycles.)
    bool is_spent() const { return state_.transparent_depth > settings_.transparent_bounces; }
    /// No limit is left: what the ray meets may still emit or be transparent, but scatters no more.
    bool is_last() const { return is_last_; }
    /// Whether that will be so after the next scattering, if a medium does it.
    bool is_last_in_medium() const {
        return is_last_ || state_.depth >= settings_.max_bounces || state_.volume_depth >= settings_.volume_bounces;
    }
    int count() const { return state_.depth; }
    /// Whether nothing but mirrors, clear glass and what is transparent lies between here and the camera.
    bool is_sharp() const { return least_density_ == std::numeric_limits<float>::infinity(); }
    /// The kind of ray now under way.
    Visibility ray_kind() const { return in_footage_ ? in_footage(ray_kind_) : ray_kind_; }
    Visibility kind_of_shadow_ray() const { return in_footage_ ? in_footage(kVisibleShadow) : kVisibleShadow; }
    Visibility kind_of_mirrored_ray() const { return in_footage_ ? in_footage(kVisibleGlossy) : kVisibleGlossy; }
    /// Lobes as this path sees them. One that has been scattered widely finds a narrow lobe by chance, and then brings
    /// much light: such lobes are made wider, and those that make caustics are dropped, as the settings say. Cycles'
    /// filter_glossy and caustics switches.
    void simplify(Closures& closures) const;
    /// From now on the path meets nothing but what stands in the footage.
    void go_into_footage() { in_footage_ = true; }
    bool is_in_footage() const { return in_footage_; }
    /// Whether the camera looks straight through to here, by way of glass that a transparent film ignores at most: the
    /// world beyond is not drawn then.
    bool sees_film() const { return settings_.film_transparent && sees_film_; }
    /// Transparent surfaces that a shadow ray from here may pass.
    int transparent_left() const { return settings_.transparent_bounces - state_.transparent_depth; }
    /// The state at a hit `length` along the ray.
    PathState at(double length) const {
        PathState state = state_;
        state.ray_length = static_cast<float>(passed_ + length);
        return state;
    }
    /// The state of a shadow ray that leaves the present vertex: one bounce further, as in Cycles.
    PathState of_shadow_ray() const;
    /// The state with which the program of a light is evaluated: of a light sampled at the present vertex, and of a
    /// lamp that the ray under way meets. A lamp gets the same state either way.
    PathState of_sampled_light() const;
    PathState of_met_lamp() const;

  private:
    const PathSettings& settings_;
    PathState state_;
    Visibility ray_kind_ = kVisibleCamera;
    float least_density_ = std::numeric_limits<float>::infinity();  ///< of its scatterings; of mirrors: infinite
    bool is_last_ = false, in_footage_ = false, sees_film_ = true;
    double passed_ = 0;  ///< length since the last scattering, before the present transparent surface
};

}  // namespace rayleaf
