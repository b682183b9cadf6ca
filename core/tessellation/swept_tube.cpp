#include "tessellation/swept_tube.h"

#include <algorithm>

namespace rayleaf {
namespace {

/// The most by which a ring stretches a vector of its profile's plane: its larger singular value.
double largest_stretch(const SweepRing& ring) {
    const double a = ring.across.dot(ring.across), b = ring.up.dot(ring.up), c = ring.across.dot(ring.up);
    return std::sqrt(0.5 * (a + b + std::sqrt((a - b) * (a - b) + 4.0 * c * c)));
}

}  // namespace

SubpatchBounds::Tube tube_around(const SweepRing (&rings)[kGridVertices], const Vec2d& middle, double reach) {
    SubpatchBounds::Tube tube;
    constexpr int kStep = kGridCells / SubpatchBounds::kLines;
    double radius = 0.0;
    for (int k = 0; k < kGridVertices; ++k) {
        const int line = std::min(k / kStep, SubpatchBounds::kLines - 1);
        const Vec3d begin = rings[line * kStep].at(middle), way = rings[(line + 1) * kStep].at(middle) - begin;
        const Vec3d from = rings[k].at(middle) - begin;
        const double squared = way.dot(way);
        const double share = squared > 0.0 ? std::clamp(from.dot(way) / squared, 0.0, 1.0) : 0.0;
        radius = std::max(radius, (from - way * share).length() + reach * largest_stretch(rings[k]));
        for (int axis = 0; k % kStep == 0 && axis < 3; ++axis)
            tube.points[axis][k / kStep] = static_cast<float>(begin[axis] + (k == kGridCells ? way[axis] : 0.0));
    }
    // The points in floats are less than a block's padding away, and so are the vertices in fixed numbers.
    tube.radius = static_cast<float>(radius) * (1.0f + 0x1p-20f) + 2.0f * kBlockPadding;
    return tube;
}

}  // namespace rayleaf
