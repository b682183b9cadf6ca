// The plain description of a bevelled curve: splines, and the profile that is swept along them.
//
// The surface is the limit of Blender's own mesh of the curve as its resolutions rise. At a point C of a spline with
// unit tangent T a frame (N, B, T) turns with the twist method and the tilt, and the profile point (x, y) lies at
//     C + radius * ((x + offset) N + y B),
// in three dimensions N and B unit and N x B = T, in two N = (-T_y, T_x, 0) and B = (0, 0, 1), and N longer at the
// points of a polygon, so that walls keep their distance. Z-up: N = z x T, so that B looks up. Where the direction
// jumps (a corner of a poly spline, a cusp) there is one more ring half way between the directions before and after.
// The outside is on the right of the profile's direction when looking along T: for a counter-clockwise profile, from N
// to B, it is the outside.
#pragma once

#include "splines/curve_splines.h"
#include "splines/sweep_builder.h"

#include <optional>
#include <string>
#include <vector>

namespace rayleaf {

enum class CurveDimensions : uint8_t { Two, Three };
/// The part of the round bevel that is kept: the side of y < 0 is the back.
enum class BevelFill : uint8_t { Full, Back, Front, Half };
/// What the taper does to the points' radius.
enum class TaperRadius : uint8_t { Override, Multiply, Add };

struct SweptCurveDescription {
    std::string name;  ///< for messages
    std::vector<CurveSplines> splines;

    CurveDimensions dimensions = CurveDimensions::Three;  ///< two: tilt and twist are ignored
    TwistMethod twist = TwistMethod::Minimum;
    ClosedTwist closed_twist = ClosedTwist::Spread;
    double bevel_depth = 0;  ///< radius of the round profile, object units; may be negative, as in Blender
    double extrude = 0;      ///< half the length of the straight part along B, object units
    double offset = 0;       ///< added to the profile's x, object units (Blender's data has this plus 1)
    BevelFill fill = BevelFill::Full;
    int bevel_resolution = 4;  ///< weight of arcs against straight parts in the texture coordinate, like `resolution`
    /// Instead of the round profile: each spline is one profile of its own, closed if cyclic. x and y are profile
    /// coordinates (Blender's bevel object gives -x and y of its own space, scaled); z, radius and tilt do not count.
    std::optional<std::vector<CurveSplines>> profile;

    /// The radius along the spline: y of the first spline over x, x from its first point (share 0) to its last (1).
    std::optional<CurveSplines> taper;
    TaperRadius taper_radius = TaperRadius::Override;
    bool taper_fits_bevel = false;  ///< the share refers to the range from bevel start to end, not to the whole spline

    double bevel_start = 0, bevel_end = 1;  ///< shares of each spline that is not cyclic; in either order
    BevelMapping start_mapping = BevelMapping::Resolution, end_mapping = BevelMapping::Resolution;
    bool fill_caps = false;  ///< flat ends close the profile of splines that are not cyclic

    /// In two dimensions: the areas between closed splines are filled, by fill group; outlines run clockwise seen from
    /// above, so that the walls' outside is outside, and holes the other way. Material slots of the areas; empty:
    /// nothing is filled. Where there is no profile, the areas lie between the splines themselves (moved by `offset`)
    /// and face upwards. Where there is one, and it is open: between its ends, at the front if `fill` is Front or Half,
    /// and at the back if it is Back or Half.
    std::vector<int> fill_materials;

    /// All but the name.
    void add_to(ContentHasher& hasher) const;
};

/// The first error in the description; splines that Blender draws nothing for are valid.
std::optional<SplineProblem> find_problem(const SweptCurveDescription& curve);

}  // namespace rayleaf
