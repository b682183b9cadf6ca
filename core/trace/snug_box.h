// The box around a shape, turned so that it is small.
#pragma once

#include "base/vector.h"

#include <array>
#include <span>

namespace rayleaf {

/// Three pairs of planes; local space.
struct SnugBox {
    std::array<Vec3d, 3> axis{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< unit and orthogonal
    std::array<double, 3> low, high;                               ///< along them

    /// Along x, y and z.
    explicit SnugBox(const Box3d& box);
    /// Along other axes, around points that lie in the box, padded as that is, where this makes the surface smaller.
    /// The axes are those of a large triangle between some of the points: T. Larsson, L. Källberg: Fast Computation of
    /// Tight-Fitting Oriented Bounding Boxes, Game Engine Gems 2 (2011).
    SnugBox(const Box3d& box, std::span<const Vec3d> points);

    double half_area() const;
};

}  // namespace rayleaf
