// From splines to the pieces of a path: directions, twist, joints and the bevel's range.
#pragma once

#include "splines/curve_splines.h"
#include "splines/sweep_path.h"

#include <vector>

namespace rayleaf {

/// How the frame turns along a spline. Minimum: without twist, starting upright. Tangent: N is the binormal; where
/// there is none (straight segments) the frame is carried along.
enum class TwistMethod : uint8_t { ZUp, Minimum, Tangent };
/// What to do if minimum twist does not close at the end of a closed spline. Spread: the angle is distributed evenly
/// over its pieces, as Blender intends. Jump: there is a seam, as in Blender's mesh up to 3.4.
enum class ClosedTwist : uint8_t { Spread, Jump };
/// What bevel start and end are shares of: pieces (Blender's resolution), segments by length and within them by
/// pieces, or the length of the spline.
enum class BevelMapping : uint8_t { Resolution, Segments, Spline };

struct SweepOptions {
    TwistMethod twist = TwistMethod::Minimum;
    ClosedTwist closed_twist = ClosedTwist::Spread;
    double bevel_start = 0, bevel_end = 1;
    BevelMapping start_mapping = BevelMapping::Resolution, end_mapping = BevelMapping::Resolution;
    bool taper_fits_bevel = false;
    std::vector<double> taper_knots;  ///< shares where the taper bends
};

/// Adds the splines of a group to the path; those that Blender draws nothing for are left out. `center` is subtracted
/// from the points. The path's space and taper must be set.
void add_splines(SweepPath& path, const CurveSplines& splines, uint32_t group, const Vec3d& center,
                 const SweepOptions& options);

/// Divides all lengths of a path.
void divide_lengths(SweepPath& path, double scale);

}  // namespace rayleaf
