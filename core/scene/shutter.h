// When a camera's film is exposed: from a random number to a moment of the shutter's time, which runs from 0 to 1.
#pragma once

#include <optional>
#include <vector>

namespace rayleaf {

struct ShutterDescription {
    /// How far the shutter is open, at even steps of time from 0 to 1; empty: all the time alike.
    std::vector<float> curve;
    /// A rolling shutter goes from the picture's upper border to the lower; a row is exposed for this share of the
    /// time. Empty: all rows are exposed together.
    std::optional<double> rolling;
};

/// Throws InputError for a curve that is not finite, and for a share beyond 0 to 1.
void validate(const ShutterDescription& shutter);

class Shutter {
  public:
    explicit Shutter(const ShutterDescription& description);

    /// `random` in [0,1); `height`: of the place on the picture, 0 at the lower border to 1.
    float time(float random, double height) const;

  private:
    std::vector<double> exposed_;  ///< up to each step of the curve, a share of all; empty: even
    std::optional<double> rolling_;

    double moment(double random) const;
};

}  // namespace rayleaf
