// The view that decides how finely shapes are diced, from Python's arguments.
#pragma once

#include "base/error.h"
#include "base/largest.h"
#include "trace/tracer.h"

#include <array>

namespace rayleaf {

inline DicingView view_from(double pixel_angle, const std::array<double, 3>& eye) {
    if (!(pixel_angle >= 0.0 && is_length(pixel_angle)))
        throw InputError("view", "pixel_angle", number_text(pixel_angle), "0 or a positive number up to 1e100");
    DicingView view;
    view.pixel_angle = pixel_angle;
    view.eye = {eye[0], eye[1], eye[2]};
    return view;
}

}  // namespace rayleaf
