#include "splines/bezier_spline.h"

#include "base/assert.h"
#include "base/largest.h"
#include "splines/bernstein.h"

namespace rayleaf {

std::optional<SplineProblem> find_problem(const BezierSpline& spline) {
    const size_t count = spline.knots.size();
    if (count < 2)
        return SplineProblem{SplineProblemKind::DrawsNothing, "point count", std::to_string(count), "2 or more"};
    for (size_t i = 0; i < count; ++i) {
        const BezierKnot& knot = spline.knots[i];
        for (const Vec3d& p : {knot.handle_left, knot.point, knot.handle_right})
            if (!is_place(p))
                return SplineProblem{SplineProblemKind::BadData, "bezier_points[" + std::to_string(i) + "]",
                                     place_text(p), kCoordinatesWanted};
    }
    return std::nullopt;
}

BezierChain to_bezier(const BezierSpline& spline) {
    RAYLEAF_ASSERT_EQ(find_problem(spline).has_value(), false);
    const size_t count = spline.knots.size();
    const size_t segments = spline.cyclic ? count : count - 1;
    BezierChain chain;
    chain.axis.degree = 3;
    chain.axis.closed = spline.cyclic;
    for (size_t i = 0; i < segments; ++i) {
        const BezierKnot &from = spline.knots[i], &to = i + 1 < count ? spline.knots[i + 1] : spline.knots.front();
        for (const Vec3d& p : {from.point, from.handle_right, to.handle_left})
            chain.points.push_back(homogeneous(p, 1.0));
        const bool joined = i + 1 < segments || spline.cyclic;
        const double total = static_cast<double>(segments);
        chain.axis.spans.push_back({static_cast<double>(i) / total, static_cast<double>(i + 1) / total,
                                    static_cast<uint32_t>(3 * i), joined ? 0 : kDisjoint});
    }
    const BezierKnot& last = spline.cyclic ? spline.knots.front() : spline.knots.back();
    chain.points.push_back(homogeneous(last.point, 1.0));
    chain.axis.point_count = static_cast<uint32_t>(chain.points.size());
    return chain;
}

}  // namespace rayleaf
