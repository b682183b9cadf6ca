// The lobes without microfacets: Lambert and Oren-Nayar, translucent, sheen, Disney diffuse; all sampled by the cosine.
#pragma once

#include "shading/lobes.h"

namespace rayleaf {

LobeValue evaluate_diffuse_lobe(const Lobe& lobe, const LobeView& view, const DirectionPair& pair);
LobeDirection sample_diffuse_lobe(const Lobe& lobe, const LobeView& view, const Vec3f& outgoing, const Vec3f& random);

}  // namespace rayleaf
