#include "splines/curve_taper.h"

#include "splines/sweep_elements.h"

#include <algorithm>

namespace rayleaf {

CurveTaper::CurveTaper(const CurveSplines& splines) {
    if (splines.counts.empty()) return;
    std::vector<SweepControl> controls;
    const SweepElements elements = sweep_elements(splines, 0, splines.counts.front(), Vec3d(0.0), controls);
    for (const SweepElement& element : elements.elements) {
        BezierCurve curve{element.segment.degree, element.segment.rational, {}};
        for (int i = 0; i <= curve.degree; ++i)
            curve.points.push_back(controls[element.segment.first_control + i].point);
        segments_.push_back(std::move(curve));
    }
    if (segments_.empty()) return;
    begin_ = segments_.front().position(0.0).x;
    length_ = segments_.back().position(1.0).x - begin_;
    for (size_t i = 0; length_ != 0.0 && i + 1 < segments_.size(); ++i) {
        const double share = (segments_[i].position(1.0).x - begin_) / length_;
        if (share > 0.0 && share < 1.0) knots_.push_back(share);
    }
}

SweepTaper::Factor CurveTaper::at(double share) const {
    if (segments_.empty() || length_ == 0.0) return {0.0, 0.0};
    const double x = begin_ + length_ * share, direction = length_ > 0.0 ? 1.0 : -1.0;
    if (share <= 0.0 || share >= 1.0) {
        const CurvePoint end = share <= 0.0 ? segments_.front().evaluate(0.0) : segments_.back().evaluate(1.0);
        return {end.position.y, end.first.x != 0.0 ? end.first.y / end.first.x * length_ : 0.0};
    }
    for (const BezierCurve& curve : segments_) {
        if ((curve.position(1.0).x - x) * direction < 0.0) continue;
        double low = 0.0, high = 1.0;
        constexpr int kHalvings = 52;
        for (int step = 0; step < kHalvings; ++step) {
            const double middle = 0.5 * (low + high);
            ((curve.position(middle).x - x) * direction < 0.0 ? low : high) = middle;
        }
        const CurvePoint point = curve.evaluate(high);
        return {point.position.y, point.first.x != 0.0 ? point.first.y / point.first.x * length_ : 0.0};
    }
    return {segments_.back().position(1.0).y, 0.0};
}

double CurveTaper::largest() const {
    double largest = 0.0;
    for (const BezierCurve& curve : segments_)
        for (const Vec4d& point : curve.points) largest = std::max(largest, std::abs(point.y / point.w));
    return largest;
}

}  // namespace rayleaf
