#include "splines/sweep_elements.h"

#include "splines/bernstein.h"

#include <algorithm>

namespace rayleaf {
namespace {

/// Blender's key interpolations: for each of four neighbouring values, its weight as a cubic by powers of t.
using Weights = std::array<std::array<double, 4>, 4>;  ///< [value][power]
constexpr double kTension = 0.71;                      ///< of its cardinal spline

constexpr Weights kLinear{{{0, 0, 0, 0}, {1, -1, 0, 0}, {0, 1, 0, 0}, {0, 0, 0, 0}}};
constexpr Weights kEase{{{0, 0, 0, 0}, {1, 0, -3, 2}, {0, 0, 3, -2}, {0, 0, 0, 0}}};
constexpr Weights kCardinal{{{0, -kTension, 2 * kTension, -kTension},
                             {1, 0, kTension - 3, 2 - kTension},
                             {0, kTension, 3 - 2 * kTension, kTension - 2},
                             {0, 0, -kTension, kTension}}};
constexpr Weights kBSpline{
    {{1.0 / 6, -0.5, 0.5, -1.0 / 6}, {2.0 / 3, 0, -1, 0.5}, {1.0 / 6, 0.5, 0.5, -0.5}, {0, 0, 0, 1.0 / 6}}};

const Weights& weights_of(PointInterpolation interpolation) {
    switch (interpolation) {
        case PointInterpolation::Cardinal:
            return kCardinal;
        case PointInterpolation::BSpline:
            return kBSpline;
        case PointInterpolation::Ease:
            return kEase;
        default:
            return kLinear;
    }
}

/// The Bezier form of the cubic between the middle two of four values.
std::array<double, 4> bezier_form(PointInterpolation interpolation, const std::array<double, 4>& values) {
    const Weights& weights = weights_of(interpolation);
    std::array<double, 4> power{};
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 4; ++k) power[k] += weights[i][k] * values[i];
    return {power[0], power[0] + power[1] / 3, power[0] + 2 * power[1] / 3 + power[2] / 3,
            power[0] + power[1] + power[2] + power[3]};
}

/// One spline of a group.
struct SplinePoints {
    const CurveSplines& group;
    size_t first, count;
    Vec3d center;

    Vec3d point(size_t i) const { return spatial_part(group.points[first + i]) - center; }
    Vec3d left(size_t i) const { return group.handles[2 * (first + i)] - center; }
    Vec3d right(size_t i) const { return group.handles[2 * (first + i) + 1] - center; }
    /// The largest coordinate of a point, as given.
    double largest(size_t i) const { return max_abs(spatial_part(group.points[first + i])); }
    double weight(size_t i) const { return group.points[first + i].w; }
    double radius(size_t i) const { return group.radii.empty() ? 1.0 : group.radii[first + i]; }
    double tilt(size_t i) const { return group.tilts.empty() ? 0.0 : group.tilts[first + i]; }
    bool straight(size_t i) const { return !group.straight.empty() && group.straight[first + i] != 0; }
};

Vec3d position_of(const SweepControl& control, bool rational) {
    return rational ? project(control.point) : spatial_part(control.point);
}

bool has_length(const SweepControl* controls, int degree, bool rational) {
    double away = 0.0, size = 0.0;
    for (int i = 0; i <= degree; ++i) {
        const Vec3d position = position_of(controls[i], rational);
        away = std::max(away, max_abs(position - position_of(controls[0], rational)));
        size = std::max(size, max_abs(position));
    }
    return away > size * 0x1p-48;
}

/// SweepSegment's.
double size_of(const SweepControl* controls, int degree, bool rational) {
    double size = 0.0;
    for (int i = 1; i <= degree; ++i)
        size = std::max(size, max_abs(position_of(controls[i], rational) - position_of(controls[i - 1], rational)));
    return size * degree;
}

/// Coordinates are in single precision, and handles are sums of them: the error of their second differences is less
/// than this share of the largest coordinate.
constexpr double kSecondRounding = 0x1p-20;
/// If second derivatives pass zero at less than this share of their change, they do so between two of Blender's
/// samples, however fine.
constexpr double kNearZero = 1e-5;

/// The direction of a cubic's second derivative if it passes through zero, else zero. On a straight line it does not
/// mean a bend.
Vec3d steady_bend(const Vec3d (&points)[4], double largest) {
    const Vec3d begin = points[0] - points[1] * 2.0 + points[2], end = points[1] - points[2] * 2.0 + points[3];
    const Vec3d change = end - begin;
    const double length = change.length(), near = std::max(kSecondRounding * largest, kNearZero * length);
    if (!(length > near)) return Vec3d(0.0);
    const Vec3d line = normalized_or(points[3] - points[0], Vec3d(0.0));
    if (!(change.cross(line).length() > near)) return Vec3d(0.0);
    const double t = std::clamp(-begin.dot(change) / (length * length), 0.0, 1.0);
    if ((begin + change * t).length() > near) return Vec3d(0.0);
    return begin.length() > near ? -change : change;
}

/// An element to be appended.
struct NewElement {
    std::vector<SweepControl> controls;
    bool straight = false, rational = false;
    double pieces_before = 0, pieces = 0;  ///< counted up to it, and its own
};

/// Appends an element if it has a length.
void append(SweepElements& result, std::vector<SweepControl>& controls, const NewElement& added) {
    const int degree = static_cast<int>(added.controls.size()) - 1;
    if (!has_length(added.controls.data(), degree, added.rational)) return;
    SweepElement element;
    element.straight = added.straight;
    element.segment.first_control = static_cast<uint32_t>(controls.size());
    element.segment.degree = static_cast<uint8_t>(degree);
    element.segment.rational = added.rational;
    element.segment.size = size_of(added.controls.data(), degree, added.rational);
    element.segment.share_begin = added.pieces_before;
    element.segment.share_end = added.pieces_before + added.pieces;
    controls.insert(controls.end(), added.controls.begin(), added.controls.end());
    result.elements.push_back(element);
}

SweepControl control(const Vec3d& position, double radius, double tilt) {
    return {homogeneous(position, 1.0), radius, tilt};
}

void add_straight(SweepElements& result, std::vector<SweepControl>& controls, const SplinePoints& spline, size_t from,
                  size_t to, double pieces_before) {
    append(result, controls,
           {{control(spline.point(from), spline.radius(from), spline.tilt(from)),
             control(spline.point(to), spline.radius(to), spline.tilt(to))},
            true,
            false,
            pieces_before,
            1.0});
}

void add_bezier(SweepElements& result, std::vector<SweepControl>& controls, const SplinePoints& spline) {
    const bool closed = result.closed;
    const size_t segments = closed ? spline.count : spline.count - 1;
    double pieces = 0.0;
    for (size_t k = 0; k < segments; ++k) {
        // Blender begins a closed spline at its last point.
        const size_t from = closed ? (k + spline.count - 1) % spline.count : k, to = (from + 1) % spline.count;
        if (spline.straight(from)) {
            add_straight(result, controls, spline, from, to, pieces);
            pieces += 1.0;
            continue;
        }
        const size_t before = from > 0 ? from - 1 : (closed ? spline.count - 1 : from);
        const size_t after = to + 1 < spline.count ? to + 1 : (closed ? 0 : to);
        const auto form = [&](PointInterpolation interpolation, auto value) {
            return bezier_form(interpolation, {value(before), value(from), value(to), value(after)});
        };
        const auto radius = form(spline.group.radius_interpolation, [&](size_t i) { return spline.radius(i); });
        const auto tilt = form(spline.group.tilt_interpolation, [&](size_t i) { return spline.tilt(i); });
        const Vec3d positions[4] = {spline.point(from), spline.right(from), spline.left(to), spline.point(to)};
        std::vector<SweepControl> added;
        added.reserve(4);
        for (int i = 0; i < 4; ++i) added.push_back(control(positions[i], radius[i], tilt[i]));
        const size_t elements = result.elements.size();
        append(result, controls, {added, false, false, pieces, static_cast<double>(spline.group.resolution)});
        if (result.elements.size() > elements)
            result.elements.back().bend = steady_bend(positions, spline.largest(from));
        pieces += spline.group.resolution;
    }
}

void add_nurbs(SweepElements& result, std::vector<SweepControl>& controls, const SplinePoints& spline) {
    NurbsCurve positions, values;
    positions.points.reserve(spline.count);
    values.points.reserve(spline.count);
    positions.direction = values.direction = spline.group.nurbs;
    for (size_t i = 0; i < spline.count; ++i) {
        const Vec3d p = spline.point(i);
        positions.points.emplace_back(p.x, p.y, p.z, spline.weight(i));
        values.points.emplace_back(spline.radius(i), spline.tilt(i), 0.0, spline.weight(i));
    }
    if (find_problem(positions)) return;
    const auto legs = static_cast<double>(result.closed ? spline.count : spline.count - 1);
    const double steps = legs * spline.group.resolution - (result.closed ? 0.0 : 1.0);
    const BezierChain chain = to_bezier(positions), scalars = to_bezier(values);
    for (const SplineSpan& span : chain.axis.spans) {
        std::vector<SweepControl> added;
        for (int i = 0; i <= chain.axis.degree; ++i) {
            const Vec4d& scalar = scalars.points[span.first_point + i];
            added.push_back({chain.points[span.first_point + i], scalar.x, scalar.y});
        }
        const size_t elements = result.elements.size();
        append(result, controls, {added, false, chain.rational, span.begin, span.end - span.begin});
        const double at = span.begin * steps;
        if (result.elements.size() > elements) result.elements.back().step_before = at - std::floor(at);
    }
}

}  // namespace

SweepElements sweep_elements(const CurveSplines& splines, size_t first, size_t count, const Vec3d& center,
                             std::vector<SweepControl>& controls) {
    SweepElements result;
    if (count < 2) return result;
    const SplinePoints spline{splines, first, count, center};
    result.closed = splines.nurbs.cyclic;
    result.ends_at_seam = result.closed && splines.ends_at_seam;
    result.end_radius = spline.radius(count - 1);
    result.end_tilt = spline.tilt(count - 1);
    switch (splines.type) {
        case CurveSplineType::Bezier:
            add_bezier(result, controls, spline);
            break;
        case CurveSplineType::Nurbs:
            add_nurbs(result, controls, spline);
            break;
        case CurveSplineType::Poly:
            for (size_t i = 0; i + 1 < count; ++i)
                add_straight(result, controls, spline, i, i + 1, static_cast<double>(i));
            if (result.closed) add_straight(result, controls, spline, count - 1, 0, static_cast<double>(count - 1));
            break;
    }
    if (result.elements.empty()) return result;
    const double begin = result.elements.front().segment.share_begin;
    const double length = result.elements.back().segment.share_end - begin;
    for (SweepElement& element : result.elements) {
        element.segment.share_begin = (element.segment.share_begin - begin) / length;
        element.segment.share_end = (element.segment.share_end - begin) / length;
    }
    if (splines.type == CurveSplineType::Nurbs && !result.closed) {
        const SweepSegment& last = result.elements.back().segment;
        const SweepControl& end = controls[last.first_control + last.degree];
        result.legs = static_cast<int>(count) - 1;
        result.end_radius = end.radius / end.point.w;
        result.end_tilt = end.tilt / end.point.w;
        result.begin_direction = spline.point(1) - spline.point(0);
        result.end_direction = spline.point(count - 1) - spline.point(count - 2);
    }
    return result;
}

}  // namespace rayleaf
