#include "splines/sweep_range.h"

#include "splines/sweep_builder.h"

#include <algorithm>
#include <array>

#include <ImathMatrixAlgo.h>
#include <ImathQuat.h>

namespace rayleaf {
namespace {

/// Gauss-Legendre rule of five points on [0,1].
constexpr std::array<std::array<double, 2>, 5> kGauss{{{0.046910077030668004, 0.118463442528094543},
                                                       {0.230765344947158454, 0.239314335249683234},
                                                       {0.5, 0.284444444444444444},
                                                       {0.769234655052841546, 0.239314335249683234},
                                                       {0.953089922969331996, 0.118463442528094543}}};
/// Equal parts of a segment that the rule is applied to.
constexpr int kLengthParts = 16;

double part_length(const SweepPath& path, const SweepSegment& segment, double begin, double end) {
    double sum = 0.0;
    for (const auto& [t, weight] : kGauss)
        sum += weight * path.point(segment, begin + (end - begin) * t).first.length();
    return sum * (end - begin);
}

double length(const SweepPath& path, const SweepSegment& segment, double begin = 0.0, double end = 1.0) {
    const double part = (end - begin) / kLengthParts;
    double sum = 0.0;
    for (int k = 0; k < kLengthParts; ++k) sum += part_length(path, segment, begin + k * part, begin + (k + 1) * part);
    return sum;
}

/// The length of a spline between two of its shares.
double length_between(const SweepPath& path, const SweepElements& elements, double from, double to) {
    double sum = 0.0;
    for (const SweepElement& element : elements.elements) {
        const double first = element.segment.share_begin, share = element.segment.share_end - first;
        const double begin = std::clamp((from - first) / share, 0.0, 1.0);
        const double end = std::clamp((to - first) / share, 0.0, 1.0);
        if (begin < end) sum += length(path, element.segment, begin, end);
    }
    return sum;
}

/// The share of a NURBS spline for mapping by segments. Its segments are the legs of the control polygon, each with an
/// equal part of the domain, whatever the knots.
double share_by_legs(const SweepPath& path, const SweepElements& elements, double wanted_share) {
    std::vector<double> lengths;
    double total = 0.0;
    for (int k = 0; k < elements.legs; ++k) {
        lengths.push_back(length_between(path, elements, static_cast<double>(k) / elements.legs,
                                         static_cast<double>(k + 1) / elements.legs));
        total += lengths.back();
    }
    double wanted = wanted_share * total;
    size_t leg = 0;
    for (; leg + 1 < lengths.size() && wanted > lengths[leg]; ++leg) wanted -= lengths[leg];
    const double inside = lengths[leg] > 0.0 ? std::min(1.0, wanted / lengths[leg]) : 0.0;
    return (static_cast<double>(leg) + inside) / elements.legs;
}

/// The parameter at which a segment has reached a length.
double parameter_at(const SweepPath& path, const SweepSegment& segment, double wanted) {
    double passed = 0.0;
    for (int k = 0; k < kLengthParts; ++k) {
        const double begin = static_cast<double>(k) / kLengthParts, end = static_cast<double>(k + 1) / kLengthParts;
        const double part = part_length(path, segment, begin, end);
        if (passed + part < wanted && k + 1 < kLengthParts) {
            passed += part;
            continue;
        }
        double low = begin, high = end;
        constexpr int kHalvings = 50;
        for (int step = 0; step < kHalvings; ++step) {
            const double middle = 0.5 * (low + high);
            (passed + part_length(path, segment, begin, middle) < wanted ? low : high) = middle;
        }
        return 0.5 * (low + high);
    }
    return 1.0;
}

/// Converts a share by some mapping to a share of the spline's pieces.
double piece_share(const SweepPath& path, const SweepElements& elements, double share, BevelMapping mapping) {
    if (mapping == BevelMapping::Resolution || share <= 0.0 || share >= 1.0) return share;
    if (mapping == BevelMapping::Segments && elements.legs > 0) return share_by_legs(path, elements, share);
    std::vector<double> lengths;
    double total = 0.0;
    for (const SweepElement& element : elements.elements) {
        lengths.push_back(length(path, element.segment));
        total += lengths.back();
    }
    double wanted = share * total;
    for (size_t i = 0; i < lengths.size(); ++i) {
        if (wanted > lengths[i] && i + 1 < lengths.size()) {
            wanted -= lengths[i];
            continue;
        }
        const SweepSegment& segment = elements.elements[i].segment;
        const double t = mapping == BevelMapping::Segments ? std::min(1.0, wanted / lengths[i])
                                                           : parameter_at(path, segment, wanted);
        return segment.share_begin + (segment.share_end - segment.share_begin) * t;
    }
    return 1.0;
}

Imath::Quatd rotation(const SweepAxes& axes) {
    const auto& [tangent, normal] = axes;
    const Vec3d up = tangent.cross(normal);
    const Imath::M44d matrix(normal.x, normal.y, normal.z, 0, up.x, up.y, up.z, 0, tangent.x, tangent.y, tangent.z, 0,
                             0, 0, 0, 1);
    return Imath::extractQuat(matrix);
}

}  // namespace

ShareRange bevel_range(const SweepPath& path, const SweepElements& elements, const SweepOptions& options) {
    const double a = piece_share(path, elements, options.bevel_start, options.start_mapping);
    const double b = piece_share(path, elements, options.bevel_end, options.end_mapping);
    return {std::min(a, b), std::max(a, b)};
}

SweepAxes interpolated_axes(const SweepAxes& from, const SweepAxes& to, double s) {
    const Imath::M33d matrix = Imath::slerpShortestArc(rotation(from), rotation(to), s).toMatrix33();
    return {normalized_or(Vec3d(matrix[2][0], matrix[2][1], matrix[2][2]), from.tangent),
            normalized_or(Vec3d(matrix[0][0], matrix[0][1], matrix[0][2]), from.normal)};
}

}  // namespace rayleaf
