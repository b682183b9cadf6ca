// The lobe of a layer of fibres (shading/microfibres.h).
#pragma once

#include "shading/lobes.h"

namespace rayleaf {

LobeValue evaluate_microfibres(const Lobe& lobe, const Vec3f& incoming, Side side);
/// With the density of its value.
LobeDirection sample_microfibres(const Lobe& lobe, const Vec3f& random);

}  // namespace rayleaf
