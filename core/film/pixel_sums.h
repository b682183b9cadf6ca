// How the samples of a pixel become its value.
#pragma once

#include "film/exact_sum.h"
#include "film/pass.h"
#include "film/pixel.h"

#include <optional>
#include <span>
#include <vector>

namespace rayleaf {

enum class PassRule {
    Mean,         ///< of all samples
    Count,        ///< how many samples there are
    FirstSample,  ///< indices and places, which cannot be averaged
    Divided       ///< mean, divided by the mean of a colour pass: light without the surface's colour
};

/// The rule of a pass, and for Divided the colour pass it is divided by.
struct PassRuleInfo {
    PassRule rule = PassRule::Mean;
    Pass color = Pass::combined;
};
PassRuleInfo rule(Pass pass);

/// The channel of a pass that is a share of the light. If a material transmits and scatters more light than arrives, it
/// is only right as a mean of many samples, and so limited to 0 to 1 in the end.
std::optional<size_t> share_of_light(Pass pass);

/// A mean of light divided by that of a colour; 0 where there is no colour.
Vec4f divided(const Vec4d& light, const Vec4d& color);

/// The passes to compute for the wanted ones: each once, with the colours that Divided passes need, and what shadow
/// catchers need.
std::vector<Pass> computed_passes(const std::vector<Pass>& wanted);

/// Values of all passes for one pixel. xyzw are the channels in order.
using PixelValues = PerPass<Vec4f>;

/// Sums of one pixel's samples, or of some of them: separate sums give the same bits when they are joined.
class PixelSums {
  public:
    /// `number`: which sample of the pixel it is.
    void add(const PixelSample& sample, int number, std::span<const Pass> passes);
    void clear(std::span<const Pass> passes);
    ExactSums& of(Pass pass) { return sums_[pass]; }
    /// The values of `count` samples, or of fewer if there are fewer; `as_means`: neither divided nor limited yet, as
    /// more samples follow.
    PixelValues values(std::span<const Pass> passes, int count, bool as_means = false) const;

  private:
    PerPass<ExactSums> sums_;  ///< of the channels
};

}  // namespace rayleaf
