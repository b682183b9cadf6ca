// The colours of interference: what is seen of white light whose spectrum is a wave.
#pragma once

#include "base/vector.h"
#include "shading/closures.h"

namespace rayleaf {

/// What an observer sees of cos(2 pi `path` / wavelength + phase), in linear Rec. 709, where 1 is white; each channel
/// has a `phase` of its own, radians. `path` in nanometres. Of long paths the waves are too close to be seen: 0.
Color seen_interference(FilmObserver observer, float path, const Color& phase);

}  // namespace rayleaf
