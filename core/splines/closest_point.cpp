#include "splines/closest_point.h"

#include <algorithm>
#include <vector>

namespace rayleaf {

namespace {

constexpr int kMostDampedSteps = 40;
constexpr double kFirstDamping = 1e-6, kMostDamping = 1e12;

ClosestPoint sample(const PatchView& patch, const Vec3d& target, double u, double v) {
    const Vec3d position = patch.position(u, v);
    return {u, v, position, (position - target).length()};
}

/// One damped Newton step on |P - target|²/2, clamped to the domain. The Hessian's diagonal is kept positive.
ClosestPoint step(const PatchView& patch, const Vec3d& target, const ClosestPoint& from, double damping) {
    const PatchPoint p = patch.evaluate(from.u, from.v);
    const Vec3d offset = p.position - target;
    const double gu = p.du.dot(offset), gv = p.dv.dot(offset);
    double uu = p.du.dot(p.du), uv = p.du.dot(p.dv), vv = p.dv.dot(p.dv);
    const double full_uu = uu + p.duu.dot(offset), full_uv = uv + p.duv.dot(offset), full_vv = vv + p.dvv.dot(offset);
    if (full_uu > 0.0 && full_vv > 0.0 && full_uu * full_vv > full_uv * full_uv) {
        uu = full_uu;
        uv = full_uv;
        vv = full_vv;
    }
    const double extra = damping * (uu + vv) + 1e-300;
    uu += extra;
    vv += extra;
    double du = 0, dv = 0;
    const bool held_u = (from.u <= 0.0 && gu > 0.0) || (from.u >= 1.0 && gu < 0.0);
    const bool held_v = (from.v <= 0.0 && gv > 0.0) || (from.v >= 1.0 && gv < 0.0);
    if (held_u && !held_v) {
        dv = -gv / vv;
    } else if (held_v && !held_u) {
        du = -gu / uu;
    } else if (!held_u) {
        const double determinant = uu * vv - uv * uv;
        du = (uv * gv - vv * gu) / determinant;
        dv = (uv * gu - uu * gv) / determinant;
    }
    return sample(patch, target, std::clamp(from.u + du, 0.0, 1.0), std::clamp(from.v + dv, 0.0, 1.0));
}

ClosestPoint refined(const PatchView& patch, const Vec3d& target, ClosestPoint best) {
    double damping = kFirstDamping;
    for (int i = 0; i < kMostDampedSteps && damping < kMostDamping; ++i) {
        const ClosestPoint next = step(patch, target, best, damping);
        if (next.distance < best.distance) {
            best = next;
            damping *= 0.1;
        } else {
            damping *= 10.0;
        }
    }
    return best;
}

}  // namespace

ClosestPoint closest_point(const PatchView& patch, const Vec3d& target) {
    std::vector<ClosestPoint> starts;
    for (int j = 0; j < kClosestPointGrid; ++j)
        for (int i = 0; i < kClosestPointGrid; ++i)
            starts.push_back(sample(patch, target, static_cast<double>(i) / (kClosestPointGrid - 1),
                                    static_cast<double>(j) / (kClosestPointGrid - 1)));
    const auto nearer = [](const ClosestPoint& a, const ClosestPoint& b) { return a.distance < b.distance; };
    std::partial_sort(starts.begin(), starts.begin() + kClosestPointStarts, starts.end(), nearer);
    starts.resize(kClosestPointStarts);
    for (ClosestPoint& start : starts) start = refined(patch, target, start);
    return *std::min_element(starts.begin(), starts.end(), nearer);
}

}  // namespace rayleaf
