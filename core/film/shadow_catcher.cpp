#include "film/shadow_catcher.h"

#include <algorithm>

namespace rayleaf {

std::vector<float> shadow_share(std::span<const float> caught, std::span<const float> alone) {
    std::vector<float> share(caught.size());
    for (size_t i = 0; i < share.size(); ++i) {
        const float* of_pixel = &alone[i / 3 * 4];
        const float light = of_pixel[i % 3], alpha = std::clamp(of_pixel[3], 0.0f, 1.0f);
        const float quotient = light != 0.0f ? caught[i] / light : 1.0f;
        share[i] = 1.0f - alpha + alpha * quotient;
    }
    return share;
}

std::vector<float> with_shadow(std::span<const float> objects, std::span<const float> share,
                               std::span<const float> footage) {
    std::vector<float> picture(objects.begin(), objects.end());
    for (size_t i = 0; i < picture.size(); i += 4) {
        const float* of_pixel = &share[i / 4 * 3];
        const float free = std::clamp((of_pixel[0] + of_pixel[1] + of_pixel[2]) / 3.0f, 0.0f, 1.0f);
        for (size_t c = 0; c < 3; ++c) picture[i + c] += free * footage[i + c];
        picture[i + 3] += (1.0f - picture[i + 3]) * (1.0f - free) + free * footage[i + 3];
    }
    return picture;
}

}  // namespace rayleaf
