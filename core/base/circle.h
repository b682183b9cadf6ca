// Points of the unit circle.
#pragma once

#include "base/vector.h"

namespace rayleaf {

/// Cosine and sine of a share of a full turn, in [0, 1], to 1.2e-7.
inline Vec2f on_circle(float turn) {
    const float quarters = 4.0f * turn;
    const int quarter = static_cast<int>(quarters + 0.5f);
    const float angle = (quarters - static_cast<float>(quarter)) * (0.5f * kPi), a2 = angle * angle;  // within pi / 4
    const float sine = angle + angle * a2 * (-1.6666654611e-1f + a2 * (8.3321608736e-3f - a2 * 1.9515295891e-4f));
    const float cosine = 1.0f - 0.5f * a2 +
                         a2 * a2 * (4.166664568298827e-2f + a2 * (-1.388731625493765e-3f + a2 * 2.443315711809948e-5f));
    // Without branches: which quarter it is cannot be predicted.
    const float both[] = {cosine, sine};
    const auto side = [](int of) { return static_cast<float>(1 - (of & 2)); };
    return {side(quarter + 1) * both[quarter & 1], side(quarter) * both[~quarter & 1]};
}

}  // namespace rayleaf
