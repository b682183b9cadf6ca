// What one camera path contributes to a pixel: one value per pass, written by an integrator, averaged by the film.
#pragma once

#include "base/vector.h"
#include "film/pass.h"

#include <array>

namespace rayleaf {

/// Values of all passes for one sample; passes that are off are simply not read. xyzw are the channels in order.
struct PixelSample {
    std::array<Vec4f, kPassCount> values;

    PixelSample() { values.fill(Vec4f(0.0f)); }

    Vec4f& operator[](Pass pass) { return values[static_cast<size_t>(pass)]; }
    const Vec4f& operator[](Pass pass) const { return values[static_cast<size_t>(pass)]; }
    void add(Pass pass, const Color& color) {
        Vec4f& value = (*this)[pass];
        value += Vec4f(color.x, color.y, color.z, 0.0f);
    }
};

}  // namespace rayleaf
