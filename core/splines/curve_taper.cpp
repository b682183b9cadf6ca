#include "splines/curve_taper.h"

#include "splines/bernstein.h"
#include "splines/sweep_elements.h"

#include <algorithm>
#include <cmath>

namespace rayleaf {
namespace {

/// Whether x of a curve runs in one direction: where that of the control points does, if need be of parts of it.
bool runs_one_way(const BezierCurve& curve, double direction, int splits = 6) {
    bool is_sure = true;
    for (size_t i = 1; i < curve.points.size(); ++i)
        is_sure &= (project(curve.points[i]).x - project(curve.points[i - 1]).x) * direction >= 0.0;
    if (is_sure || splits == 0) return is_sure;
    const auto [begin, end] = curve.split(0.5);
    return runs_one_way(begin, direction, splits - 1) && runs_one_way(end, direction, splits - 1);
}

}  // namespace

CurveTaper::CurveTaper(const CurveSplines& splines) {
    if (splines.counts.empty()) return;
    std::vector<SweepControl> controls;
    const SweepElements elements = sweep_elements(splines, 0, splines.counts.front(), Vec3d(0.0), controls);
    for (const SweepElement& element : elements.elements) {
        BezierCurve curve{element.segment.degree, element.segment.rational, {}};
        for (int i = 0; i <= curve.degree; ++i)
            curve.points.push_back(controls[element.segment.first_control + i].point);
        const double end = curve.position(1.0).x;
        segments_.push_back({std::move(curve), end, false});
    }
    if (segments_.empty()) return;
    begin_ = segments_.front().curve.position(0.0).x;
    length_ = segments_.back().end - begin_;
    for (Segment& segment : segments_) segment.rises = runs_one_way(segment.curve, length_);
    for (size_t i = 0; length_ != 0.0 && i + 1 < segments_.size(); ++i) {
        const double share = (segments_[i].end - begin_) / length_;
        if (share > 0.0 && share < 1.0) knots_.push_back(share);
    }
}

/// Where a segment passes x: by halving, and where x runs one way by Newton's steps while they stay in between and
/// become shorter.
template <typename BasisAt>
double CurveTaper::parameter_at(const Segment& segment, double x, double direction, const BasisAt& basis_at) {
    const BezierCurve& curve = segment.curve;
    StackBuffer<double, kStackDegree + 1> beyond(
        curve.points.size());  // how far control points lie beyond x, by weight
    for (size_t i = 0; i < curve.points.size(); ++i)
        beyond[i] = (curve.points[i].x - x * curve.points[i].w) * direction;
    const double from = beyond[0], to = beyond[curve.points.size() - 1];
    double low = 0.0, high = 1.0, t = segment.rises && from < 0.0 && to > 0.0 ? from / (from - to) : 0.5;
    double last_step = 1.0;
    bool by_newton = false;
    constexpr int kMostSteps = 52;
    constexpr double kLastStep = 0x1p-50;
    for (int i = 0; i < kMostSteps && low < high; ++i) {
        const auto basis = basis_at(t);
        const double at = basis.value(beyond.data()), slope = basis.first(beyond.data());
        (at < 0.0 ? low : high) = t;
        const double step = at / slope, newton = t - step;
        const bool rises = segment.rises && slope > 0.0;
        // Newton's steps go with the square of those before.
        const double next_step = by_newton ? std::abs(step) * (step / last_step) * (step / last_step) : std::abs(step);
        if (rises && next_step <= kLastStep) return std::clamp(newton, 0.0, 1.0);
        by_newton = rises && newton > low && newton < high && std::abs(step) < 0.5 * last_step;
        const double next = by_newton ? newton : 0.5 * (low + high);
        last_step = std::abs(next - t);
        t = next;
    }
    return t;
}

template <typename BasisAt>
SweepTaper::Factor CurveTaper::factor_at(const Segment& segment, double x, const BasisAt& basis_at) const {
    const BezierCurve& curve = segment.curve;
    const auto basis = basis_at(parameter_at(segment, x, length_ > 0.0 ? 1.0 : -1.0, basis_at));
    const Vec4d at = basis.value(curve.points.data()), change = basis.first(curve.points.data());
    const double w = curve.rational ? at.w : 1.0, w_change = curve.rational ? change.w : 0.0;
    const double y = at.y / w, run = change.x - at.x / w * w_change, rise = change.y - y * w_change;
    return {y, run != 0.0 ? rise / run * length_ : 0.0};
}

SweepTaper::Factor CurveTaper::at(double share) const {
    if (segments_.empty() || length_ == 0.0) return {0.0, 0.0};
    if (share <= 0.0 || share >= 1.0) {
        const CurvePoint end =
            share <= 0.0 ? segments_.front().curve.evaluate(0.0) : segments_.back().curve.evaluate(1.0);
        return {end.position.y, end.first.x != 0.0 ? end.first.y / end.first.x * length_ : 0.0};
    }
    const double x = begin_ + length_ * share, direction = length_ > 0.0 ? 1.0 : -1.0;
    for (const Segment& segment : segments_) {
        if ((segment.end - x) * direction < 0.0) continue;
        constexpr int kCubic = 3;
        if (segment.curve.degree == kCubic)
            return factor_at(segment, x, [](double t) { return FixedBernsteinBasis<kCubic>(t); });
        return factor_at(segment, x, [&](double t) { return BernsteinBasis(segment.curve.degree, t); });
    }
    return {segments_.back().curve.position(1.0).y, 0.0};
}

double CurveTaper::largest() const {
    double largest = 0.0;
    for (const Segment& segment : segments_)
        for (const Vec4d& point : segment.curve.points) largest = std::max(largest, std::abs(point.y / point.w));
    return largest;
}

}  // namespace rayleaf
