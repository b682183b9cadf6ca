#include "splines/bezier_spline.h"

#include "base/assert.h"
#include "splines/bernstein.h"

namespace rayleaf {

std::optional<SplineProblem> find_problem(const BezierSpline& spline) {
    const size_t count = spline.knots.size();
    if (count < 2)
        return SplineProblem{SplineProblemKind::DrawsNothing, "point count", std::to_string(count), "2 or more"};
    for (size_t i = 0; i < count; ++i) {
        const BezierKnot& knot = spline.knots[i];
        if (!is_finite(knot.handle_left) || !is_finite(knot.point) || !is_finite(knot.handle_right))
            return SplineProblem{SplineProblemKind::BadData, "bezier_points[" + std::to_string(i) + "]",
                                 "not a finite number", "finite coordinates"};
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
        const BezierKnot &from = spline.knots[i], &to = spline.knots[(i + 1) % count];
        for (const Vec3d& p : {from.point, from.handle_right, to.handle_left})
            chain.points.push_back(homogeneous(p, 1.0));
        const double share = 1.0 / static_cast<double>(segments);
        const bool joined = i + 1 < segments || spline.cyclic;
        chain.axis.spans.push_back({static_cast<double>(i) * share, static_cast<double>(i + 1) * share,
                                    static_cast<uint32_t>(3 * i), joined ? 0 : kDisjoint});
    }
    chain.points.push_back(homogeneous(spline.knots[segments % count].point, 1.0));
    chain.axis.point_count = static_cast<uint32_t>(chain.points.size());
    return chain;
}

}  // namespace rayleaf
