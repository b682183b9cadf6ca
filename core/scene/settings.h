// What an artist sets for a render.
#pragma once

#include "film/pass.h"
#include "film/pixel_filter.h"

#include <cstdint>
#include <vector>

namespace rayleaf {

struct Settings {
    int width = 0, height = 0;            ///< of the whole picture, pixels
    int crop_x = 0, crop_y = 0;           ///< lower left corner of the rendered part
    int crop_width = 0, crop_height = 0;  ///< its size; 0: the whole picture
    int samples = 64;                     ///< paths per pixel
    uint32_t seed = 0;
    int threads = 0;     ///< 0: all the machine's
    int tile_size = 32;  ///< pixels

    int max_bounces = 12, diffuse_bounces = 4, glossy_bounces = 4, transmission_bounces = 12, transparent_bounces = 8;
    int roulette_start = 3;                       ///< bounces after which Russian roulette may end a path
    float clamp_direct = 0, clamp_indirect = 10;  ///< largest component of one contribution; 0: no limit
    bool film_transparent = false;
    PixelFilterKind filter = PixelFilterKind::BlackmanHarris;
    float filter_width = 1.5f;  ///< pixels, as Blender's panel counts it (film/pixel_filter.h)
    float exposure = 1;         ///< factor on radiance, as Blender's Film exposure

    std::vector<Pass> passes = {Pass::combined};
};

/// Throws InputError that names the first setting out of its range.
void validate(const Settings& settings);

/// The rendered part of the picture in pixels, lower left corner and size: the crop, or the whole.
struct Window {
    int x = 0, y = 0, width = 0, height = 0;
};
inline Window window(const Settings& s) {
    if (s.crop_width == 0 || s.crop_height == 0) return {0, 0, s.width, s.height};
    return {s.crop_x, s.crop_y, s.crop_width, s.crop_height};
}

}  // namespace rayleaf
