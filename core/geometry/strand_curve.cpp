#include "geometry/strand_curve.h"

namespace rayleaf {

StrandPoint StrandSegment::at(double s) const {
    const double r = 1.0 - s;
    const StrandPoint a = points[0] * r + points[1] * s, b = points[1] * r + points[2] * s;
    const StrandPoint c = points[2] * r + points[3] * s;
    return (a * r + b * s) * r + (b * r + c * s) * s;
}

StrandPoint StrandSegment::derivative(double s) const {
    const double r = 1.0 - s;
    const StrandPoint a = points[1] - points[0], b = points[2] - points[1], c = points[3] - points[2];
    return ((a * r + b * s) * r + (b * r + c * s) * s) * 3.0;
}

void StrandSegment::halve(StrandSegment& left, StrandSegment& right) const {
    const StrandPoint a = (points[0] + points[1]) * 0.5, b = (points[1] + points[2]) * 0.5;
    const StrandPoint c = (points[2] + points[3]) * 0.5, ab = (a + b) * 0.5, bc = (b + c) * 0.5;
    const StrandPoint middle = (ab + bc) * 0.5, first = points[0], last = points[3];
    left.points = {first, a, ab, middle};
    right.points = {middle, bc, c, last};
}

StrandSegment StrandSegment::part(uint32_t level, uint32_t index) const {
    StrandSegment result = *this;
    for (uint32_t bit = level; bit-- > 0;) {
        StrandSegment left, right;
        result.halve(left, right);
        result = ((index >> bit) & 1u) != 0 ? right : left;
    }
    return result;
}

Box3d StrandSegment::bounds() const {
    Box3d box;
    double radius = 0.0;
    for (const StrandPoint& p : points) {
        box.extendBy(axis_point(p));
        radius = std::max(radius, p.w);
    }
    return {box.min - Vec3d(radius), box.max + Vec3d(radius)};
}

StrandSegment bezier_segment(StrandBasis basis, const std::array<StrandPoint, 4>& p) {
    StrandSegment result;
    switch (basis) {
        case StrandBasis::Linear:
            result.points = {p[1], p[1] + (p[2] - p[1]) / 3.0, p[2] - (p[2] - p[1]) / 3.0, p[2]};
            break;
        case StrandBasis::CatmullRom:
            result.points = {p[1], p[1] + (p[2] - p[0]) / 6.0, p[2] - (p[3] - p[1]) / 6.0, p[2]};
            break;
        case StrandBasis::BSpline:
            result.points = {(p[0] + p[1] * 4.0 + p[2]) / 6.0, (p[1] * 2.0 + p[2]) / 3.0, (p[1] + p[2] * 2.0) / 3.0,
                             (p[1] + p[2] * 4.0 + p[3]) / 6.0};
            break;
        case StrandBasis::Bezier:
            result.points = p;
            break;
    }
    for (StrandPoint& point : result.points) point.w = std::max(point.w, 0.0);
    return result;
}

}  // namespace rayleaf
