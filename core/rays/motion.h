// How an object or a camera moves while the shutter is open.
#pragma once

#include "base/vector.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace rayleaf {

/// The middle of the shutter's time, which runs from 0 to 1.
inline constexpr float kMiddleTime = 0.5f;

/// A time within the shutter's; NaN counts as 0.
inline float shutter_time(float time) {
    return time > 0.0f ? std::min(time, 1.0f) : 0.0f;
}

/// Where a time lies among even steps of the shutter's time, the first at 0 and the last at 1: so far from one step to
/// the next.
struct StepShare {
    size_t first = 0;
    double share = 0;
};
/// `steps`: at least two.
StepShare step_share(float time, size_t steps);

/// The time of one of the steps.
inline float time_of_step(size_t step, size_t steps) {
    return static_cast<float>(step) / static_cast<float>(steps - 1);
}

/// A place in each moment of the shutter's time. Between two known places the rotation turns at constant speed, the
/// short way; the translation, and what is left of the map (scale, shear), go along lines: as Cycles 3.4 has it.
class Motion {
  public:
    /// `places` at even steps of time, the first at 0 and the last at 1: at least two, of finite numbers. If one has no
    /// rotation, because it is flat, all numbers go along lines.
    explicit Motion(std::span<const Affine3d> places);

    /// Before 0 it stands where it begins, after 1 where it ends; NaN counts as 0.
    Affine3d at(float time) const;
    /// Holds the images of a box in all moments.
    Box3d bounds(const Box3d& box) const;
    /// The places at the steps.
    size_t steps() const { return keys_.size(); }
    float time_of(size_t step) const { return time_of_step(step, keys_.size()); }

  private:
    /// A map as rotation * rest, then translation.
    struct Key {
        Vec4d rotation{1, 0, 0, 0};  ///< unit quaternion, the scalar first
        Affine3d rest;               ///< linear
        Vec3d translation{0, 0, 0};
        double half_turn = 0;  ///< half the angle from here to the next, radians
    };
    std::vector<Key> keys_;

    void add(const Affine3d& place, bool turns);
    Affine3d between(size_t first, double share) const;
    void add_bounds(size_t first, const Box3d& box, Box3d& bounds) const;
};

}  // namespace rayleaf
