// A ray against one piece of a strand, in double precision.
//
// All is done in the ray's own frame: z along the ray, x and y across, the origin where the ray is near the shape. The
// ball around C(s) is met where phi(s) = x² + y² - r² <= 0, from z - sqrt(-phi) to z + sqrt(-phi). Over a stretch of s
// where phi <= 0 these intervals overlap, so the ray is inside the swept balls from the least of the one to the largest
// of the other: both are found by Newton's method between brackets on a part of the curve where each has one extremum.
// That holds where phi is convex enough against z (a condition on Bernstein coefficients); elsewhere the piece is
// halved.
#pragma once

#include "trace/strand_frame.h"

#include <array>
#include <limits>
#include <optional>

namespace rayleaf {

/// Where the ray is inside a piece: distances along it from the frame's origin, and the parameters of the piece whose
/// balls it touches there.
struct StrandSpan {
    double enter = 0, leave = 0;
    double s_enter = 0, s_leave = 0;
};

/// A cubic can come near a ray so often.
inline constexpr int kMostSpans = 4;

struct StrandSpans {
    std::array<StrandSpan, kMostSpans> spans;
    int count = 0;

    /// Takes a span, joined with those it overlaps.
    void add(StrandSpan span);
};

/// The spans of a piece in the ray's frame. Where the ray enters at `needs_leave_before` or later, `leave` may be
/// infinite: not computed.
StrandSpans round_spans(const StrandSegment& piece,
                        double needs_leave_before = std::numeric_limits<double>::infinity());

/// Where the axis of a piece comes nearest to the ray, within its radius.
struct RibbonHit {
    double distance = 0, s = 0;
    int end =
        0;  ///< -1 or 1: at the start or the end of the piece, and nearer still beyond unless the strand turns there
};

struct RibbonHits {
    std::array<RibbonHit, kMostSpans> hits;
    int count = 0;
};

RibbonHits ribbon_hits(const StrandSegment& piece);

/// Whether the axis, past the end of a piece at `point`, runs away from the ray or along it; `direction` is that of the
/// strand, not of the way out. `end` as above.
bool recedes(const StrandPoint& point, const StrandPoint& direction, int end);

/// The span of a ball of the given centre and radius (frame), if the ray meets it.
std::optional<StrandSpan> ball_span(const StrandPoint& ball);

}  // namespace rayleaf
