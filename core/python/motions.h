// Motions of instances and cameras from Python's matrices.
#pragma once

#include "python/arrays.h"
#include "scene/checks.h"

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rayleaf {

/// `matrices` (n, 4, 4) at even steps of the shutter's time.
inline std::vector<Affine3d> places_of(const std::string& object, const Array<double>& matrices) {
    check_shape(object, "motion", matrices, {-1, 4, 4});
    std::vector<Affine3d> places;
    for (py::ssize_t i = 0; i < matrices.shape(0); ++i) places.push_back(affine_of(object, matrices.data() + 16 * i));
    return places;
}

/// Null where nothing moves.
inline std::shared_ptr<const Motion> motion_of(const std::string& object, const Array<double>& matrices) {
    return checked_motion(object, places_of(object, matrices));
}

using InstanceMotions = std::map<py::ssize_t, Array<double>>;  ///< by place in the list: (steps, 4, 4)

inline std::shared_ptr<const Motion> motion_at(const std::optional<InstanceMotions>& motions, const std::string& name,
                                               py::ssize_t i) {
    if (!motions) return nullptr;
    const auto found = motions->find(i);
    return found == motions->end() ? nullptr : motion_of(name, found->second);
}

/// (n, 4): lower left corner, upper right corner.
inline std::vector<std::array<Vec2d, 2>> windows_of(const Array<double>& corners) {
    check_shape("camera", "windows", corners, {-1, 4});
    std::vector<std::array<Vec2d, 2>> windows;
    for (const double* c = corners.data(); c != corners.data() + corners.size(); c += 4)
        windows.push_back({Vec2d(c[0], c[1]), Vec2d(c[2], c[3])});
    return windows;
}

}  // namespace rayleaf
