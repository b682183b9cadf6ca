// Lobes of Blender's Toon BSDF: the same all over a cone of directions, with a soft border.
#pragma once

#include "shading/lobes.h"

namespace rayleaf {

LobeValue evaluate_toon_lobe(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& incoming, Side side);
std::optional<LobeDirection> sample_toon_lobe(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& random);

}  // namespace rayleaf
