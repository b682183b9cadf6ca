#include "geometry/strand_curve.h"

#include <limits>

namespace rayleaf {
namespace {

/// The points of both halves that are not ends of the whole: the left one's are a, ab, middle, the right one's middle,
/// bc, c.
struct StrandHalves {
    Double4 a, ab, middle, bc, c;
};

StrandHalves halves_of(const Double4& p0, const Double4& p1, const Double4& p2, const Double4& p3) {
    const Double4 a = (p0 + p1) * 0.5, b = (p1 + p2) * 0.5, c = (p2 + p3) * 0.5;
    const Double4 ab = (a + b) * 0.5, bc = (b + c) * 0.5;
    return {a, ab, (ab + bc) * 0.5, bc, c};
}

}  // namespace

StrandPoint StrandSegment::at(double s) const {
    const double r = 1.0 - s;
    const Double4 p0(points[0]), p1(points[1]), p2(points[2]), p3(points[3]);
    const Double4 a = p0 * r + p1 * s, b = p1 * r + p2 * s, c = p2 * r + p3 * s;
    return StrandPoint((a * r + b * s) * r + (b * r + c * s) * s);
}

StrandPoint StrandSegment::derivative(double s) const {
    const double r = 1.0 - s;
    const StrandPoint a = points[1] - points[0], b = points[2] - points[1], c = points[3] - points[2];
    return ((a * r + b * s) * r + (b * r + c * s) * s) * 3.0;
}

void StrandSegment::halve(StrandSegment& left, StrandSegment& right) const {
    const Double4 p0(points[0]), p1(points[1]), p2(points[2]), p3(points[3]);
    const auto [a, ab, middle, bc, c] = halves_of(p0, p1, p2, p3);
    left.points = {StrandPoint(p0), StrandPoint(a), StrandPoint(ab), StrandPoint(middle)};
    right.points = {StrandPoint(middle), StrandPoint(bc), StrandPoint(c), StrandPoint(p3)};
}

StrandSegment StrandSegment::part(uint32_t level, uint32_t index) const {
    if (level == 0) return *this;
    Double4 p0(points[0]), p1(points[1]), p2(points[2]), p3(points[3]);
    for (uint32_t bit = level; bit-- > 0;) {
        const auto [a, ab, middle, bc, c] = halves_of(p0, p1, p2, p3);
        if (((index >> bit) & 1u) != 0)
            p0 = middle, p1 = bc, p2 = c;
        else
            p1 = a, p2 = ab, p3 = middle;
    }
    return {{StrandPoint(p0), StrandPoint(p1), StrandPoint(p2), StrandPoint(p3)}};
}

Box3d StrandSegment::bounds() const {
    Double4 least(points[0]), most = least;
    for (size_t i = 1; i < points.size(); ++i) {
        least = smaller(least, Double4(points[i]));
        most = larger(most, Double4(points[i]));
    }
    const double radius = std::max(most.w(), 0.0);
    return {Vec3d(least.x(), least.y(), least.z()) - Vec3d(radius),
            Vec3d(most.x(), most.y(), most.z()) + Vec3d(radius)};
}

StrandSegment bezier_segment(StrandBasis basis, const std::array<Double4, 4>& p) {
    constexpr double kThird = 1.0 / 3.0, kSixth = 1.0 / 6.0;
    StrandSegment result;
    // A radius that overshoots below zero becomes zero.
    const auto point = [](const Double4& q) {
        const Double4::Pair least{-std::numeric_limits<double>::infinity(), 0.0};
        return StrandPoint(Double4(q.low, q.high > least ? q.high : least));
    };
    const auto set = [&](const Double4& a, const Double4& b, const Double4& c, const Double4& d) {
        result.points = {point(a), point(b), point(c), point(d)};
    };
    switch (basis) {
        case StrandBasis::Linear:
            set(p[1], p[1] + (p[2] - p[1]) * kThird, p[2] - (p[2] - p[1]) * kThird, p[2]);
            break;
        case StrandBasis::CatmullRom:
            set(p[1], p[1] + (p[2] - p[0]) * kSixth, p[2] - (p[3] - p[1]) * kSixth, p[2]);
            break;
        case StrandBasis::BSpline:
            set((p[0] + p[1] * 4.0 + p[2]) * kSixth, (p[1] * 2.0 + p[2]) * kThird, (p[1] + p[2] * 2.0) * kThird,
                (p[1] + p[2] * 4.0 + p[3]) * kSixth);
            break;
        case StrandBasis::Bezier:
            set(p[0], p[1], p[2], p[3]);
            break;
    }
    return result;
}

}  // namespace rayleaf
