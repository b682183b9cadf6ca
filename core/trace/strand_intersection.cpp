#include "trace/strand_intersection.h"

#include "base/double4.h"

#include <algorithm>
#include <limits>

namespace rayleaf {
namespace {

/// How often a piece is halved at most where it has more than one extremum, as far as can be told; then it is taken as
/// if it had one. Doubt beyond the first depth is mostly about one place, so that only few parts go on: those are
/// counted, for a ray that runs along a straight wall leaves all in doubt.
constexpr int kDeep = 8, kDeepest = 30, kMostDeepHalvings = 200;
/// Steps of the bracketed Newton iteration; bisection alone would need 53.
constexpr int kMostNewtonSteps = 60;
/// Rounding of products of coordinates, relative to the largest.
constexpr double kProductRounding = 16 * std::numeric_limits<double>::epsilon();
/// The parameter is exact when a step moves the axis by less than this share of the radius: a distance along the ray
/// is an extremum, so its error is the square of that.
constexpr double kStepShare = 1e-7;

using Coefficients = std::array<double, 7>;

/// Values of the piece's functions at a parameter. phi is half of the one in the header.
struct At {
    double x, y, z, r, dx, dy, dz, dr, ddx, ddy, ddz, ddr;

    /// At the begin of a piece, or at its end.
    static At first(const StrandSegment& piece) {
        const Double4 a(piece.points[0]), b(piece.points[1]), c(piece.points[2]);
        return {a, (b - a) * 3.0, ((c - b) - (b - a)) * 6.0};
    }
    static At last(const StrandSegment& piece) {
        const Double4 b(piece.points[1]), c(piece.points[2]), d(piece.points[3]);
        return {d, (d - c) * 3.0, ((d - c) - (c - b)) * 6.0};
    }
    At(const Double4& value, const Double4& first, const Double4& second) { set(value, first, second); }
    void set(const Double4& value, const Double4& first, const Double4& second) {
        x = value.x(), y = value.y(), z = value.z(), r = value.w();
        dx = first.x(), dy = first.y(), dz = first.z(), dr = first.w();
        ddx = second.x(), ddy = second.y(), ddz = second.z(), ddr = second.w();
    }
    At(const StrandSegment& piece, double s) {
        const Double4 p[] = {Double4(piece.points[0]), Double4(piece.points[1]), Double4(piece.points[2]),
                             Double4(piece.points[3])};
        const double t = 1.0 - s;
        const Double4 a = p[0] * t + p[1] * s, b = p[1] * t + p[2] * s, c = p[2] * t + p[3] * s;
        const Double4 d = a * t + b * s, e = b * t + c * s;
        set(d * t + e * s, (e - d) * 3.0, ((c - b) - (b - a)) * 6.0);
    }
    double inside() const { return r * r - (x * x + y * y); }  ///< -2 phi
    double phi_first() const { return x * dx + y * dy - r * dr; }
    double phi_second() const { return dx * dx + dy * dy - dr * dr + x * ddx + y * ddy - r * ddr; }
    double across_first() const { return x * dx + y * dy; }
    double across_second() const { return dx * dx + dy * dy + x * ddx + y * ddy; }
};

/// x² + y² - r² in Bernstein form of degree 6; without r where `radius` is 0.
Coefficients squared_distance(const StrandSegment& piece, double radius) {
    const std::array<StrandPoint, 4>& p = piece.points;
    const auto product = [&](int i, int j) { return p[i].x * p[j].x + p[i].y * p[j].y - radius * p[i].w * p[j].w; };
    return {product(0, 0),
            product(0, 1),
            (2.0 * product(0, 2) + 3.0 * product(1, 1)) / 5.0,
            (product(0, 3) + 9.0 * product(1, 2)) / 10.0,
            (2.0 * product(1, 3) + 3.0 * product(2, 2)) / 5.0,
            product(2, 3),
            product(3, 3)};
}

double largest_radius(const StrandSegment& piece) {
    return std::max(std::max(piece.points[0].w, piece.points[1].w), std::max(piece.points[2].w, piece.points[3].w));
}

/// Whether the ray surely passes the piece: the axis is nowhere further from its chord than the bound of its second
/// differences.
bool surely_missed(const StrandSegment& piece, double radius) {
    const std::array<StrandPoint, 4>& p = piece.points;
    const double bend_x = std::max(std::abs(p[0].x - 2.0 * p[1].x + p[2].x), std::abs(p[1].x - 2.0 * p[2].x + p[3].x));
    const double bend_y = std::max(std::abs(p[0].y - 2.0 * p[1].y + p[2].y), std::abs(p[1].y - 2.0 * p[2].y + p[3].y));
    // |C - chord| <= max|C''| / 8, and |C''| <= 6 max|second difference|.
    const double reach = radius + 0.75 * (bend_x + bend_y);
    const double dx = p[3].x - p[0].x, dy = p[3].y - p[0].y, length2 = dx * dx + dy * dy;
    const double along = -(p[0].x * dx + p[0].y * dy);
    const double s = length2 > 0.0 ? std::clamp(along / length2, 0.0, 1.0) : 0.0;
    const double x = p[0].x + dx * s, y = p[0].y + dy * s;
    const double size = std::abs(p[0].x) + std::abs(p[0].y) + std::abs(dx) + std::abs(dy);
    return x * x + y * y > reach * reach * (1.0 + 1e-6) + kProductRounding * size * size;
}

double least_second_difference(const Coefficients& c) {
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 5; ++i) least = std::min(least, c[i] - 2.0 * c[i + 1] + c[i + 2]);
    return least;
}

/// A rising function at a place: value, slope, the length of the smallest step that matters, and whether the slope
/// holds for the neighbourhood (beside a root's zero it does not, and a short step tells nothing).
struct Slope {
    double value, slope, step;
    bool trusted;
};

/// The zero of a function that rises from below zero at `low` to above it at `high`: Newton's steps, halving where one
/// would leave the bracket or is not half as long as the one before the last, or where a short step turns out not to
/// have crossed the zero.
template <typename Evaluate>
double rising_zero(const Evaluate& evaluate, double low, double high, double start) {
    double s = std::clamp(start, low, high);
    bool probing = false;
    double step_before = high - low, last_step = high - low;
    for (int i = 0; i < kMostNewtonSteps; ++i) {
        const Slope at = evaluate(s);
        if (at.value == 0.0) return s;
        (at.value < 0.0 ? low : high) = s;
        if (high - low <= 2.0 * at.step) return 0.5 * (low + high);
        const double newton = s - at.value / at.slope;
        const bool shrinks = std::abs(newton - s) <= 0.5 * step_before;
        const bool usable = !probing && shrinks && at.slope > 0.0 && newton > low && newton < high;
        double next = usable ? newton : 0.5 * (low + high);
        probing = false;
        if (next <= low || next >= high) return next;
        if (usable && std::abs(next - s) <= at.step) {
            if (at.trusted) return s;
            next = std::clamp(s + std::copysign(2.0 * at.step, next - s), low, high);
            probing = true;
        }
        step_before = last_step;
        last_step = std::abs(next - s);
        s = next;
    }
    return s;
}

/// The smallest step of the parameter that matters: nowhere on the piece does it move or change a ball by more than a
/// share of the radius. Not by the speed at one place: at a cusp the axis stands still.
double step_of(const StrandSegment& piece, double radius) {
    double speed = 0.0;
    for (size_t i = 0; i < 3; ++i) {
        const StrandPoint d = piece.points[i + 1] - piece.points[i];
        speed = std::max(speed, 3.0 * (std::abs(d.x) + std::abs(d.y) + std::abs(d.z) + std::abs(d.w)));
    }
    return speed > 0.0 ? kStepShare * radius / speed : 1.0;
}

/// The functions at both ends of a piece.
struct Ends {
    At first, last;
};

/// About where the axis comes nearest to the ray, radius counted, and how far inside the ray is there.
struct Nearest {
    double s, inside;
    double bend, dz;  ///< there: phi'' and z'

    Nearest(const StrandSegment& piece, const Ends& ends) {
        const auto& [first, last] = ends;
        const double dx = last.x - first.x, dy = last.y - first.y, length2 = dx * dx + dy * dy;
        s = length2 > 0.0 ? std::clamp(-(first.x * dx + first.y * dy) / length2, 0.0, 1.0) : 0.5;
        const At at(piece, s);
        inside = at.inside();
        bend = at.phi_second();
        dz = at.dz;
        if (!(bend > 0.0)) return;
        const double step = at.phi_first() / bend;
        s -= step;
        inside += at.phi_first() * step;
    }
};

/// A place of a piece, and its functions there.
struct PlaceOnPiece {
    double s;
    At at;
};

/// The least of  side z - sqrt(inside)  over [0,1]: where its derivative times the root changes sign. Outside the balls
/// the root counts as zero, and the sign is that of the way back to them.
PlaceOnPiece extreme_place(const StrandSegment& piece, const Ends& ends, double side, const Nearest& nearest,
                           double step) {
    const auto slope_of = [&](const At& at) {
        const double inside = at.inside(), root = inside > 0.0 ? std::sqrt(inside) : 0.0;
        const double value = side * at.dz * root + at.phi_first();
        const double bend = root > 0.0 ? side * (at.ddz * root - at.dz * at.phi_first() / root) : 0.0;
        const double own = at.phi_second();
        return Slope{value, own + bend, step, std::abs(bend) <= own};
    };
    if (slope_of(ends.first).value >= 0.0) return {0.0, ends.first};
    if (slope_of(ends.last).value <= 0.0) return {1.0, ends.last};
    // As if straight and of one radius: phi = A x² - W, so the extremum lies at -k sqrt(W / (A² + k² A)).
    const double a = nearest.bend, k = side * nearest.dz, w = std::max(nearest.inside, 0.0);
    const double offset = a > 0.0 ? -k * std::sqrt(w / (a * (a + k * k))) : 0.0;
    PlaceOnPiece place{0.0, ends.first};
    const auto evaluate = [&](double s) {
        place = {s, At(piece, s)};
        return slope_of(place.at);
    };
    const double s = rising_zero(evaluate, 0.0, 1.0, nearest.s + offset);
    return s == place.s ? place : PlaceOnPiece{s, At(piece, s)};
}

/// The span of a piece that has one nearest place at most.
std::optional<StrandSpan> simple_span(const StrandSegment& piece, double radius, double needs_leave_before) {
    const Ends ends{At::first(piece), At::last(piece)};
    const double step = step_of(piece, radius);
    const Nearest nearest(piece, ends);
    // Of a ray that passes by, both extrema are where it is nearest.
    const auto find_end = [&](double side, double& s, double& distance) {
        const PlaceOnPiece place = extreme_place(piece, ends, side, nearest, step);
        const At& at = place.at;
        s = place.s;
        const double inside = at.inside();
        distance = at.z - side * std::sqrt(std::max(inside, 0.0));
        return inside > 0.0;
    };
    StrandSpan span;
    if (!find_end(1.0, span.s_enter, span.enter)) return std::nullopt;
    span.leave = std::numeric_limits<double>::infinity();
    if (span.enter < needs_leave_before) find_end(-1.0, span.s_leave, span.leave);
    return span;
}

/// The same for a piece that hardly bends, however its parameter runs along it. It is told by u, the place along the
/// chord: of a straight piece all functions are linear in it, squares apart. Second derivatives by u are
/// (C'' u' - C' u'') / u'^3, the numerator is bounded by its Bernstein coefficients.
bool is_nearly_straight(const StrandSegment& piece, double radius) {
    const std::array<StrandPoint, 4>& p = piece.points;
    const StrandPoint chord = p[3] - p[0];
    const double length2 = axis_point(chord).length2();
    if (!(length2 > 0.0)) return false;
    std::array<StrandPoint, 3> d;
    std::array<double, 3> u;
    for (size_t i = 0; i < 3; ++i) {
        d[i] = p[i + 1] - p[i];
        u[i] = axis_point(d[i]).dot(axis_point(chord)) / length2;
    }
    const double slowest = std::min(u[0], std::min(u[1], u[2]));
    if (!(slowest > 0.0)) return false;
    const StrandPoint e[2] = {d[1] - d[0], d[2] - d[1]};
    const double b[2] = {u[1] - u[0], u[2] - u[1]};
    const std::array<StrandPoint, 4> numerator = {
        e[0] * u[0] - d[0] * b[0], (e[1] * u[0] + e[0] * (2.0 * u[1]) - d[0] * b[1] - d[1] * (2.0 * b[0])) / 3.0,
        (e[1] * (2.0 * u[1]) + e[0] * u[2] - d[1] * (2.0 * b[1]) - d[2] * b[0]) / 3.0, e[1] * u[2] - d[2] * b[1]};
    double across2 = 0.0, along = 0.0, change = 0.0, farthest2 = 0.0;
    for (size_t i = 0; i < 4; ++i) {
        across2 = std::max(across2, numerator[i].x * numerator[i].x + numerator[i].y * numerator[i].y);
        along = std::max(along, std::abs(numerator[i].z));
        change = std::max(change, std::abs(numerator[i].w));
        farthest2 = std::max(farthest2, p[i].x * p[i].x + p[i].y * p[i].y);
    }
    // Both derivatives of C by s have factors, 3 and 6, as have those of u; a little more than all that rounding adds.
    const double scale = 1.001 * (3.0 * 6.0) / (27.0 * slowest * slowest * slowest);
    const double bend = scale * std::sqrt(across2), speed = std::sqrt(chord.x * chord.x + chord.y * chord.y) - bend;
    const double widening = std::abs(chord.w) + scale * change;
    // phi'' must outweigh z'' by the radius, as below.
    const double least = speed * speed - std::sqrt(farthest2) * bend - widening * widening - radius * scale * change;
    return speed > 0.0 && least > radius * scale * along;
}

/// Whether the ray enters the balls at one place of the piece at most, and leaves them at one, as far as can be told
/// from control points.
bool has_one_extremum(const StrandSegment& piece, double radius) {
    const std::array<StrandPoint, 4>& p = piece.points;
    const Coefficients c = squared_distance(piece, 1.0);
    // phi'' >= 30 least and z'' <= 6 bend: -sqrt(-phi) bends up by 15 least / r, which must outweigh z.
    const double least = least_second_difference(c);
    const double bend = std::max(std::abs(p[0].z - 2.0 * p[1].z + p[2].z), std::abs(p[1].z - 2.0 * p[2].z + p[3].z));
    if (least > 0.0 && 5.0 * least >= 2.0 * radius * bend) return true;
    if (is_nearly_straight(piece, radius)) return true;
    // Along the axis, inside it: z' >= 3 rise outweighs the root's slope, at most 3 change / sqrt(-phi).
    const double nearest = *std::max_element(c.begin(), c.end());
    if (!(nearest < 0.0)) return false;
    double change = 0.0;
    for (int i = 0; i < 6; ++i) change = std::max(change, std::abs(c[i + 1] - c[i]));
    const double steps[3] = {p[1].z - p[0].z, p[2].z - p[1].z, p[3].z - p[2].z};
    const double rise =
        std::max(std::min(steps[0], std::min(steps[1], steps[2])), std::min(-steps[0], std::min(-steps[1], -steps[2])));
    return rise * std::sqrt(-nearest) > change;
}

void add_round(const StrandSegment& piece, double begin, double size, int depth, int& deep_halvings,
               StrandSpans& result) {
    const double radius = largest_radius(piece);
    if (!(radius > 0.0) || surely_missed(piece, radius)) return;
    const bool is_last = depth == kDeepest || (depth >= kDeep && deep_halvings >= kMostDeepHalvings);
    if (is_last || has_one_extremum(piece, radius)) {
        std::optional<StrandSpan> span = simple_span(piece, radius, std::numeric_limits<double>::infinity());
        if (!span) return;
        span->s_enter = begin + span->s_enter * size;
        span->s_leave = begin + span->s_leave * size;
        result.add(*span);
        return;
    }
    StrandSegment left, right;
    piece.halve(left, right);
    if (depth >= kDeep) ++deep_halvings;
    add_round(left, begin, 0.5 * size, depth + 1, deep_halvings, result);
    add_round(right, begin + 0.5 * size, 0.5 * size, depth + 1, deep_halvings, result);
}

void add_ribbon(const StrandSegment& piece, double begin, double size, int depth, RibbonHits& result) {
    const double radius = largest_radius(piece);
    if (!(radius > 0.0) || surely_missed(piece, radius)) return;
    if (depth < kDeep && !(least_second_difference(squared_distance(piece, 0.0)) > 0.0)) {
        StrandSegment left, right;
        piece.halve(left, right);
        add_ribbon(left, begin, 0.5 * size, depth + 1, result);
        add_ribbon(right, begin + 0.5 * size, 0.5 * size, depth + 1, result);
        return;
    }
    const double step = step_of(piece, radius);
    const auto evaluate = [&](double s) {
        const At at(piece, s);
        return Slope{at.across_first(), at.across_second(), step, true};
    };
    const std::array<StrandPoint, 4>& p = piece.points;
    double s = 0.0;
    if (evaluate(0.0).value < 0.0) {
        const StrandPoint d = p[3] - p[0];
        const double length2 = d.x * d.x + d.y * d.y;
        const double start = length2 > 0.0 ? -(p[0].x * d.x + p[0].y * d.y) / length2 : 0.5;
        s = evaluate(1.0).value <= 0.0 ? 1.0 : rising_zero(evaluate, 0.0, 1.0, start);
    }
    const At at(piece, s);
    if (!(at.inside() > 0.0) || result.count == kMostSpans) return;
    const double place = begin + s * size;
    const bool halved_here = (s == 0.0 && place > 0.0) || (s == 1.0 && place < 1.0);
    const int end = s == 0.0 ? -1 : s == 1.0 ? 1 : 0;
    if (halved_here && !recedes(p[end < 0 ? 0 : 3], p[end < 0 ? 1 : 3] - p[end < 0 ? 0 : 2], end)) return;
    result.hits[result.count++] = {at.z, place, halved_here ? 0 : end};
}

/// Whether the axis is a point: nothing along it could be told apart, however often it is halved.
bool is_one_ball(const StrandSegment& piece) {
    return std::all_of(piece.points.begin() + 1, piece.points.end(),
                       [&](const StrandPoint& point) { return point == piece.points[0]; });
}

}  // namespace

void StrandSpans::add(StrandSpan span) {
    for (int i = 0; i < count;) {
        const StrandSpan& other = spans[i];
        if (other.enter > span.leave || span.enter > other.leave) {
            ++i;
            continue;
        }
        if (other.enter < span.enter) span.enter = other.enter, span.s_enter = other.s_enter;
        if (other.leave > span.leave) span.leave = other.leave, span.s_leave = other.s_leave;
        spans[i] = spans[--count];
    }
    if (count < kMostSpans) spans[count++] = span;
}

StrandSpans round_spans(const StrandSegment& piece, double needs_leave_before) {
    StrandSpans result;
    const double radius = largest_radius(piece);
    if (!(radius > 0.0) || surely_missed(piece, radius)) return result;
    if (is_one_ball(piece)) {
        if (const std::optional<StrandSpan> span = ball_span(piece.points[0])) result.add(*span);
        return result;
    }
    if (has_one_extremum(piece, radius)) {
        if (const std::optional<StrandSpan> span = simple_span(piece, radius, needs_leave_before)) result.add(*span);
        return result;
    }
    int deep_halvings = 0;
    add_round(piece, 0.0, 1.0, 0, deep_halvings, result);
    return result;
}

RibbonHits ribbon_hits(const StrandSegment& piece) {
    RibbonHits result;
    add_ribbon(piece, 0.0, 1.0, 0, result);
    return result;
}

bool recedes(const StrandPoint& point, const StrandPoint& direction, int end) {
    const double x = point.x * direction.x, y = point.y * direction.y;
    // A smooth join may seem to come nearer on either side by rounding: better found twice than never.
    constexpr double kTie = 1e-9;
    return end * (x + y) >= -kTie * (std::abs(x) + std::abs(y));
}

std::optional<StrandSpan> ball_span(const StrandPoint& ball) {
    const double inside = ball.w * ball.w - (ball.x * ball.x + ball.y * ball.y);
    if (!(inside > 0.0)) return std::nullopt;
    const double root = std::sqrt(inside);
    return StrandSpan{ball.z - root, ball.z + root, 0.0, 0.0};
}

}  // namespace rayleaf
