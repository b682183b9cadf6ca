// Which part of a spline the bevel covers, and frames between two rings.
#pragma once

#include "base/vector.h"
#include "splines/sweep_elements.h"

#include <vector>

namespace rayleaf {

enum class BevelMapping : uint8_t;
struct SweepOptions;

/// A range of shares of a spline.
struct ShareRange {
    double begin = 0, end = 1;

    bool overlaps(double from, double to) const { return to > begin && from < end; }
    /// Whether rings at one place belong to it: those at the ends of the spline always do, if the range reaches there.
    bool holds_joint(double share) const {
        return (share > begin || (share == 0.0 && begin == 0.0)) && (share < end || (share == 1.0 && end == 1.0));
    }
};

/// The part of an open spline between bevel start and end; begin < end unless they are equal.
ShareRange bevel_range(const SweepPath& path, const SweepElements& elements, const SweepOptions& options);

/// Unit vectors at right angles.
struct SweepAxes {
    Vec3d tangent, normal;
};

/// The axes a share s of the way from one ring to another: the rotation between them with its angle times s.
SweepAxes interpolated_axes(const SweepAxes& from, const SweepAxes& to, double s);

}  // namespace rayleaf
