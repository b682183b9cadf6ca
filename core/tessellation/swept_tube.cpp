#include "tessellation/swept_tube.h"

#include <algorithm>

namespace rayleaf {
namespace {

/// The largest factor by which a ring scales a vector of its profile's plane: its larger singular value.
double largest_stretch(const SweepRing& ring) {
    const double a = ring.across.dot(ring.across), b = ring.up.dot(ring.up), c = ring.across.dot(ring.up);
    return std::sqrt(0.5 * (a + b + std::sqrt((a - b) * (a - b) + 4.0 * c * c)));
}

}  // namespace

SubpatchBounds::Tube tube_around(std::span<const SweepRing> rings, const Vec2d& middle, double reach) {
    SubpatchBounds::Tube tube;
    const int last = static_cast<int>(rings.size()) - 1, step = last / SubpatchBounds::kLines;
    double radius = 0.0;
    for (int k = 0; k <= last; ++k) {
        const int line = std::min(k / step, SubpatchBounds::kLines - 1);
        const Vec3d begin = rings[line * step].at(middle), way = rings[(line + 1) * step].at(middle) - begin;
        const Vec3d from = rings[k].at(middle) - begin;
        const double squared = way.dot(way);
        const double share = squared > 0.0 ? std::clamp(from.dot(way) / squared, 0.0, 1.0) : 0.0;
        radius = std::max(radius, (from - way * share).length() + reach * largest_stretch(rings[k]));
        for (int axis = 0; k % step == 0 && axis < 3; ++axis)
            tube.points[axis][k / step] = static_cast<float>(begin[axis] + (k == last ? way[axis] : 0.0));
    }
    // Rounding to floats, and of vertices to fixed-point numbers, moves points by less than a block's padding.
    tube.radius = static_cast<float>(radius) * (1.0f + 0x1p-20f) + 2.0f * kBlockPadding;
    return tube;
}

Box3d box_of(const SweepRing& ring, double extent) {
    Vec3d reach;
    for (int axis = 0; axis < 3; ++axis) reach[axis] = extent * std::hypot(ring.across[axis], ring.up[axis]);
    return {ring.center - reach, ring.center + reach};
}

}  // namespace rayleaf
