// The areas between closed splines of a curve in two dimensions, filled at the ends of its profile.
//
// The border of an area is the ring of each of its splines at an end of the profile, the exact curve; the area itself
// is flat wherever the radius does not change along the splines. Parameters of a hit, and texture coordinates: the
// place in the rectangle around the area, along x and y.
#pragma once

#include "geometry/shape.h"
#include "geometry/swept_curve.h"
#include "splines/sweep_path.h"
#include "splines/sweep_profile.h"

#include <cstdint>
#include <vector>

namespace rayleaf {

enum class FillSide : uint8_t { Back, Front };  ///< seen from below, from above

/// The border of areas: the end of the profile, in its plane.
struct FillBorder {
    Vec2d place{0, 0};
    FillSide side = FillSide::Front;
};

/// The area of one fill group on one side.
struct SweptFill {
    FillBorder border;
    uint32_t material_slot = 0;
    std::vector<uint32_t> splines;  ///< of the path
    Vec3d low{0, 0, 0};             ///< the rectangle around it, local space: a corner,
    Vec2d size{0, 0};               ///< and its sides
    /// Polygons near the border, and where each begins: to decide which points of the rectangle emit light.
    std::vector<Vec2f> outlines;
    std::vector<uint32_t> begins;

    Vec3d normal() const { return Vec3d(0, 0, border.side == FillSide::Front ? 1.0 : -1.0); }
    Vec3d at(const Vec2f& parameters) const;
    Vec2f parameters(const Vec3d& position) const;
    bool covers(const Vec3d& position) const;
    float rectangle_area() const { return static_cast<float>(size.x * size.y); }
    LocalSurface surface(const LocalHit& hit) const;
    size_t bytes() const;
};

std::vector<FillBorder> fill_borders(const SweptCurveDescription& curve, const std::vector<SweepProfile>& profiles);

/// `path` in local space.
std::vector<SweptFill> swept_fills(const SweptCurveDescription& curve, const SweepPath& path,
                                   const std::vector<FillBorder>& borders);

}  // namespace rayleaf
