#include "splines/curve_taper.h"

#include "splines/bernstein.h"
#include "splines/sweep_elements.h"

#include <algorithm>
#include <cmath>

namespace rayleaf {
namespace {

/// Whether x of the control points runs in one direction, and with it that of the curve.
bool runs_one_way(const BezierCurve& curve, double direction) {
    for (size_t i = 1; i < curve.points.size(); ++i)
        if ((project(curve.points[i]).x - project(curve.points[i - 1]).x) * direction < 0.0) return false;
    return true;
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
double CurveTaper::parameter_at(const Segment& segment, double x, double direction) {
    double low = 0.0, high = 1.0, t = 0.5, last_step = 1.0;
    constexpr int kMostSteps = 52;
    constexpr double kLastStep = 0x1p-50;
    for (int i = 0; i < kMostSteps && low < high; ++i) {
        const CurvePoint at = segment.curve.evaluate(t);
        const double beyond = (at.position.x - x) * direction, slope = at.first.x * direction;
        (beyond < 0.0 ? low : high) = t;
        const double step = beyond / slope, newton = t - step;
        const bool rises = segment.rises && slope > 0.0;
        if (rises && std::abs(step) <= kLastStep) return std::clamp(newton, 0.0, 1.0);
        const bool usable = rises && newton > low && newton < high && std::abs(step) < 0.5 * last_step;
        const double next = usable ? newton : 0.5 * (low + high);
        last_step = std::abs(next - t);
        t = next;
    }
    return t;
}

SweepTaper::Factor CurveTaper::at(double share) const {
    if (segments_.empty() || length_ == 0.0) return {0.0, 0.0};
    const double x = begin_ + length_ * share, direction = length_ > 0.0 ? 1.0 : -1.0;
    if (share <= 0.0 || share >= 1.0) {
        const CurvePoint end =
            share <= 0.0 ? segments_.front().curve.evaluate(0.0) : segments_.back().curve.evaluate(1.0);
        return {end.position.y, end.first.x != 0.0 ? end.first.y / end.first.x * length_ : 0.0};
    }
    for (const Segment& segment : segments_) {
        if ((segment.end - x) * direction < 0.0) continue;
        const CurvePoint point = segment.curve.evaluate(parameter_at(segment, x, direction));
        return {point.position.y, point.first.x != 0.0 ? point.first.y / point.first.x * length_ : 0.0};
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
