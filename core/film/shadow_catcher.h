// What shadow catchers show: how much the other objects change their light, as Cycles tells it.
//
// Objects and lamps stand in the footage, a filmed world, or are added to it. Samples that see a catcher keep the light
// that it scatters with all objects and with those of the footage alone. Both are means until a picture is asked for:
// only there one is divided by the other. So samples may be added in rounds, and in parts.
#pragma once

#include <span>
#include <vector>

namespace rayleaf {

/// Pixels of Pass::shadow_catcher: `caught` (RGB) over `alone` (RGBA, A the alpha of all), pixel by pixel.
std::vector<float> shadow_share(std::span<const float> caught, std::span<const float> alone);

/// Pixels of Combined with the shadow in alpha, over `footage` where that is in the picture. All but `share` (RGB):
/// RGBA.
std::vector<float> with_shadow(std::span<const float> objects, std::span<const float> share,
                               std::span<const float> footage);

}  // namespace rayleaf
