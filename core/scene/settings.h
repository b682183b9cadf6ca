// What an artist sets for a render.
#pragma once

#include "film/pass.h"

#include <cstdint>
#include <vector>

namespace rayleaf {

enum class PixelFilter : uint8_t { Box, Gaussian, BlackmanHarris };

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
    PixelFilter filter = PixelFilter::BlackmanHarris;
    float filter_width = 1.5f;  ///< pixels, full width
    float exposure = 1;         ///< factor on radiance, as Blender's Film exposure

    std::vector<Pass> passes = {Pass::combined};
};

}  // namespace rayleaf
