#include "splines/nurbs.h"

#include "base/assert.h"
#include "base/largest.h"
#include "splines/bernstein.h"

#include <algorithm>
#include <cmath>

namespace rayleaf {

namespace {

/// Number of points with the repeated ones of a cyclic direction.
int wrapped_count(int count, const NurbsDirection& direction) {
    return count + (direction.cyclic ? direction.order - 1 : 0);
}

/// A control point of the refined net: a blend of degree + 1 consecutive points of the given one, indices wrapping.
struct RefinedPoint {
    int first_point;
    std::vector<double> weights;
};

/// How the Bezier control points of a direction follow from its points.
struct Refinement {
    SplineAxis axis;
    std::vector<RefinedPoint> points;
};

/// The blossom of the span that starts at knot `span` with `ends` arguments at its end and the others at its begin.
RefinedPoint blossom(const std::vector<double>& knots, int degree, int span, int ends) {
    const size_t size = static_cast<size_t>(degree) + 1;
    std::vector<std::vector<double>> weights(size, std::vector<double>(size, 0.0));
    for (size_t i = 0; i < size; ++i) weights[i][i] = 1.0;
    for (int level = 1; level <= degree; ++level) {
        const double t = level <= ends ? knots[span + 1] : knots[span];
        for (int i = degree; i >= level; --i) {
            const double low = knots[span - degree + i], high = knots[span + 1 + i - level];
            const double share = (t - low) / (high - low);
            for (size_t k = 0; k < size; ++k) weights[i][k] = weights[i - 1][k] * (1.0 - share) + weights[i][k] * share;
        }
    }
    return {span - degree, std::move(weights.back())};
}

int knot_multiplicity(const std::vector<double>& knots, double knot) {
    const auto [first, last] = std::equal_range(knots.begin(), knots.end(), knot);
    return static_cast<int>(last - first);
}

Refinement refine(int count, const NurbsDirection& direction) {
    const std::vector<double> knots = implied_knots(count, direction);
    const KnotDomain domain = knot_domain(count, direction);
    const int degree = direction.order - 1;
    Refinement out;
    out.axis.degree = degree;
    out.axis.closed = direction.cyclic;
    std::vector<int> spans;
    for (int i = degree; i < wrapped_count(count, direction); ++i)
        if (knots[i] < knots[i + 1]) spans.push_back(i);
    for (const int span : spans) {
        SplineSpan piece;
        piece.begin = (knots[span] - domain.begin) / (domain.end - domain.begin);
        piece.end = (knots[span + 1] - domain.begin) / (domain.end - domain.begin);
        piece.first_point = static_cast<uint32_t>(out.points.size());
        const bool last = span == spans.back();
        if (!last || direction.cyclic) piece.continuity_after = degree - knot_multiplicity(knots, knots[span + 1]);
        for (int k = 0; k < degree; ++k) out.points.push_back(blossom(knots, degree, span, k));
        const bool border_is_next = !last && piece.continuity_after >= 0;
        if (!border_is_next) out.points.push_back(blossom(knots, degree, span, degree));
        out.axis.spans.push_back(piece);
    }
    if (direction.cyclic) out.points.back() = out.points.front();
    out.axis.point_count = static_cast<uint32_t>(out.points.size());
    return out;
}

/// Applies a refinement to one line of points: `count` of them, `stride` apart.
void apply(const Refinement& refinement, const Vec4d* points, size_t count, size_t stride, Vec4d* refined,
           size_t refined_stride) {
    for (size_t i = 0; i < refinement.points.size(); ++i) {
        const RefinedPoint& recipe = refinement.points[i];
        Vec4d sum(0.0);
        size_t index = static_cast<size_t>(recipe.first_point) % count;
        for (const double weight : recipe.weights) {
            sum += points[index * stride] * weight;
            if (++index == count) index = 0;
        }
        refined[i * refined_stride] = sum;
    }
}

/// Homogeneous points; weights that are all equal become 1. Returns whether they differ.
bool to_homogeneous(const std::vector<Vec4d>& points, std::vector<Vec4d>& out) {
    const double first_weight = points.front().w;
    const bool rational =
        std::any_of(points.begin(), points.end(), [&](const Vec4d& p) { return p.w != first_weight; });
    out.reserve(points.size());
    for (const Vec4d& p : points) out.push_back(homogeneous({p.x, p.y, p.z}, rational ? p.w : 1.0));
    return rational;
}

void make_polynomial(std::vector<Vec4d>& points) {
    for (Vec4d& p : points) p.w = 1.0;  // sums of rounded weights may be off in the last place
}

SplineProblem draws_nothing(std::string argument, std::string got, std::string wanted) {
    return {SplineProblemKind::DrawsNothing, std::move(argument), std::move(got), std::move(wanted)};
}

std::optional<SplineProblem> find_direction_problem(int count, const NurbsDirection& direction,
                                                    const std::string& suffix) {
    const std::string points = "point count" + suffix, got = std::to_string(count);
    const int order = direction.order;
    if (order < 2)
        return SplineProblem{SplineProblemKind::BadData, "order" + suffix, std::to_string(order), "2 or more"};
    if (count < 2) return draws_nothing(points, got, "2 or more");
    if (count < order) return draws_nothing(points, got, "at least the order, " + std::to_string(order));
    if (!direction.bezier) return std::nullopt;
    if (direction.cyclic && count % (order - 1) != 0)
        return draws_nothing(
            points, got,
            "a multiple of the order - 1, " + std::to_string(order - 1) + ", for cyclic with Bezier knots");
    if (!direction.cyclic && !direction.endpoint && count <= order)
        return draws_nothing(points, got, "more than the order, " + std::to_string(order) + ", for Bezier knots");
    return std::nullopt;
}

std::optional<SplineProblem> find_point_problem(const std::vector<Vec4d>& points) {
    for (size_t i = 0; i < points.size(); ++i) {
        const Vec4d& p = points[i];
        const auto name = [i] { return "points[" + std::to_string(i) + ']'; };
        if (!is_place(spatial_part(p)))
            return SplineProblem{SplineProblemKind::BadData, name(), place_text(spatial_part(p)), kCoordinatesWanted};
        if (!(p.w > 0.0) || !is_length(p.w))
            return SplineProblem{SplineProblemKind::BadData, name() + ".weight", number_text(p.w),
                                 "a positive number up to 1e100"};
    }
    return std::nullopt;
}

}  // namespace

std::optional<SplineProblem> find_problem(const NurbsSurface& surface) {
    if (surface.count_u < 0 || surface.count_v < 0 ||
        surface.points.size() != static_cast<size_t>(surface.count_u) * static_cast<size_t>(surface.count_v))
        return SplineProblem{SplineProblemKind::BadData, "points", std::to_string(surface.points.size()),
                             std::to_string(surface.count_u) + " x " + std::to_string(surface.count_v)};
    if (auto problem = find_direction_problem(surface.count_u, surface.u, " in u")) return problem;
    if (auto problem = find_direction_problem(surface.count_v, surface.v, " in v")) return problem;
    return find_point_problem(surface.points);
}

std::optional<SplineProblem> find_problem(const NurbsCurve& curve) {
    auto problem = find_direction_problem(static_cast<int>(curve.points.size()), curve.direction, "");
    if (!problem) return find_point_problem(curve.points);
    if (problem->kind == SplineProblemKind::DrawsNothing) problem->kind = SplineProblemKind::DrawsControlPolygon;
    return problem;
}

std::vector<double> implied_knots(int count, const NurbsDirection& direction) {
    const int order = direction.order;
    const int inner = direction.bezier ? order - 1 : 1;
    const bool endpoint_cyclic = direction.endpoint && direction.cyclic;
    // A cyclic spline with end points has a single knot before the first block, so that the block has room to wrap.
    const int lead = endpoint_cyclic ? 1 : 0;
    int first = direction.bezier ? std::min(2, inner) : 1;
    if (direction.endpoint) first = order - lead;
    const int tail = direction.cyclic ? 2 * order - 1 : (direction.endpoint ? order : 0);
    std::vector<double> knots(static_cast<size_t>(wrapped_count(count, direction) + order), 0.0);
    const int body = static_cast<int>(knots.size()) - tail;

    double knot = lead;
    int left = first;  // of the block of equal knots
    for (int i = lead; i < body; ++i) {
        knots[i] = knot;
        if (--left == 0) {
            knot += 1.0;
            left = inner;
        }
    }
    // The tail repeats the spacing of the first knots: all equal for end points, one period on for cyclic splines.
    for (int i = 0; i < tail; ++i) knots[body + i] = knot + (knots[i] - knots[0]);
    return knots;
}

KnotDomain knot_domain(int count, const NurbsDirection& direction) {
    const std::vector<double> knots = implied_knots(count, direction);
    return {knots[direction.order - 1], knots[wrapped_count(count, direction)]};
}

BezierCurve BezierChain::segment(size_t index) const {
    const auto first = points.begin() + axis.spans[index].first_point;
    return {axis.degree, rational, {first, first + axis.degree + 1}};
}

BezierPatch BezierNet::patch(size_t span_u, size_t span_v) const {
    BezierPatch out{u.degree, v.degree, rational, {}};
    out.points.reserve(static_cast<size_t>(u.degree + 1) * static_cast<size_t>(v.degree + 1));
    const size_t column = u.spans[span_u].first_point, row = v.spans[span_v].first_point;
    for (size_t j = row; j <= row + static_cast<size_t>(v.degree); ++j) {
        const Vec4d* begin = points.data() + j * u.point_count + column;
        out.points.insert(out.points.end(), begin, begin + u.degree + 1);
    }
    return out;
}

Vec3d BezierChain::position(double t) const {
    const size_t span = axis.span_at(t);
    return segment(span).position(axis.local_parameter(span, t));
}

Vec3d BezierNet::position(double at_u, double at_v) const {
    const size_t span_u = u.span_at(at_u), span_v = v.span_at(at_v);
    return patch(span_u, span_v).position(u.local_parameter(span_u, at_u), v.local_parameter(span_v, at_v));
}

BezierNet to_bezier(const NurbsSurface& surface) {
    RAYLEAF_ASSERT_EQ(find_problem(surface).has_value(), false);
    const Refinement along_u = refine(surface.count_u, surface.u), along_v = refine(surface.count_v, surface.v);
    BezierNet net{along_u.axis, along_v.axis, false, {}};
    std::vector<Vec4d> given;
    net.rational = to_homogeneous(surface.points, given);
    const size_t columns = net.u.point_count, rows = static_cast<size_t>(surface.count_v);
    const auto given_columns = static_cast<size_t>(surface.count_u);
    std::vector<Vec4d> half(columns * rows);
    for (size_t j = 0; j < rows; ++j)
        apply(along_u, given.data() + j * given_columns, given_columns, 1, half.data() + j * columns, 1);
    net.points.resize(columns * net.v.point_count);
    for (size_t i = 0; i < columns; ++i) apply(along_v, half.data() + i, rows, columns, net.points.data() + i, columns);
    if (!net.rational) make_polynomial(net.points);
    return net;
}

BezierChain to_bezier(const NurbsCurve& curve) {
    RAYLEAF_ASSERT_EQ(find_problem(curve).has_value(), false);
    const Refinement refinement = refine(static_cast<int>(curve.points.size()), curve.direction);
    BezierChain chain{refinement.axis, false, {}};
    std::vector<Vec4d> given;
    chain.rational = to_homogeneous(curve.points, given);
    chain.points.resize(chain.axis.point_count);
    apply(refinement, given.data(), given.size(), 1, chain.points.data(), 1);
    if (!chain.rational) make_polynomial(chain.points);
    return chain;
}

}  // namespace rayleaf
