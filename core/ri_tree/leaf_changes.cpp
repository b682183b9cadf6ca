#include "ri_tree/leaf_changes.h"

namespace rayleaf {
namespace {

/// The derivative of a unit vector by those of two of its components.
Vec3f unfolded_change(const FoldedVector& folded, const Vec3d& unit, float a, float b) {
    const int first = (folded.third + 1) % 3, second = (folded.third + 2) % 3;
    Vec3f change;
    change[first] = a;
    change[second] = b;
    change[folded.third] = static_cast<float>(-(unit[first] * a + unit[second] * b) / unit[folded.third]);
    return change;
}

bool is_finite_step(const HitChanges::Step& step) {
    return is_finite(step.normal) && std::isfinite(step.uv.x) && std::isfinite(step.uv.y) &&
           is_finite(step.exit_position) && is_finite(step.exit_direction);
}

}  // namespace

StepsInCell steps_in_cell(const BatchFrame& frame, const CellPlace& cell, const LineGeometry& line,
                          const Vec3d& from_center, const RayDifferential& differential) {
    const int axis = line.axis;
    const Vec3f positions[] = {differential.dp_dx, differential.dp_dy};
    const Vec3f directions[] = {differential.dd_dx, differential.dd_dy};
    StepsInCell made;
    for (int step = 0; step < kPictureSteps; ++step) {
        const Vec3d dp(positions[step]), dd(directions[step]);
        for (int i = 0; i < 2; ++i) {
            const int other = (axis + 1 + i) % 3;
            const double slope = (dd[other] - line.slope[i] * dd[axis]) / line.direction[axis];
            const double intercept = dp[other] - line.slope[i] * dp[axis] - slope * from_center[axis];
            const auto in_cell = [&](int k, double change) {
                return static_cast<float>(
                    std::ldexp(change * frame.inverse_half_sides[axis][k], kPlaceBits - cell.bits[k]));
            };
            made.steps[step][i] = in_cell(i, intercept);
            made.steps[step][i + 2] = in_cell(i + 2, slope);
        }
    }
    return made;
}

HitChanges hit_changes(const OutputChanges& changes, double scale) {
    HitChanges result;
    for (int i = 0; i < kPictureSteps; ++i) {
        HitChanges::Step& step = result.steps[i];
        step.normal = Vec3f(changes[i].normal);
        step.exit_position = Vec3f(changes[i].exit_position * scale);
        step.exit_direction = Vec3f(changes[i].exit_direction);
        if (!is_finite_step(step)) return {};
    }
    result.are_known = true;
    return result;
}

HitChanges output_changes(OutputKind kind, const CellLeaf& leaf, const float (&changes)[kPictureSteps][kLeafPadding],
                          const OutputRay& out) {
    HitChanges result;
    if (kind == OutputKind::Volume) return result;
    for (int i = 0; i < kPictureSteps; ++i) {
        HitChanges::Step& step = result.steps[i];
        step.normal = unfolded_change(leaf.normal, out.normal, changes[i][1], changes[i][2]);
        if (kind == OutputKind::Simple) {
            step.uv = {changes[i][3], changes[i][4]};
        } else if (kind == OutputKind::Glass) {
            step.exit_position = {changes[i][3], changes[i][4], changes[i][5]};
            step.exit_direction =
                unfolded_change(leaf.exit_direction, out.exit_direction, changes[i][6], changes[i][7]);
        }
        if (!is_finite_step(step)) return {};
    }
    result.are_known = true;
    return result;
}

}  // namespace rayleaf
