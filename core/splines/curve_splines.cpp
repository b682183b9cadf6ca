#include "splines/curve_splines.h"

#include "base/largest.h"

#include <algorithm>
#include <numeric>

namespace rayleaf {
namespace {

SplineProblem bad(std::string argument, std::string got, std::string wanted) {
    return {SplineProblemKind::BadData, std::move(argument), std::move(got), std::move(wanted)};
}

std::optional<SplineProblem> size_problem(const char* argument, size_t got, size_t wanted) {
    if (got == wanted) return std::nullopt;
    return bad(argument, std::to_string(got) + " of them", std::to_string(wanted));
}

std::optional<SplineProblem> number_problem(const char* argument, const std::vector<double>& values) {
    const auto found = std::find_if(values.begin(), values.end(), [](double value) { return !is_length(value); });
    if (found == values.end()) return std::nullopt;
    return bad(std::string(argument) + '[' + std::to_string(found - values.begin()) + ']', number_text(*found),
               "a finite number up to 1e100");
}

std::optional<SplineProblem> point_problem(const CurveSplines& splines) {
    const bool rational = splines.type == CurveSplineType::Nurbs;
    for (size_t i = 0; i < splines.points.size(); ++i) {
        const Vec4d& p = splines.points[i];
        if (!is_place(spatial_part(p)))
            return bad("points[" + std::to_string(i) + ']', place_text(spatial_part(p)), kCoordinatesWanted);
        if (rational && (!(p.w > 0.0) || !is_length(p.w)))
            return bad("points[" + std::to_string(i) + "].weight", number_text(p.w), "a positive number up to 1e100");
    }
    for (size_t i = 0; i < splines.handles.size(); ++i)
        if (const Vec3d& p = splines.handles[i]; !is_place(p))
            return bad("handles[" + std::to_string(i / 2) + ']', place_text(p), kCoordinatesWanted);
    return std::nullopt;
}

}  // namespace

std::optional<SplineProblem> find_problem(const CurveSplines& splines) {
    /// Blender's panel allows up to 1024. Beyond this limit the number of a spline's pieces could overflow.
    constexpr int kLargestResolution = 1 << 16;
    const size_t count = splines.points.size();
    const bool bezier = splines.type == CurveSplineType::Bezier;
    const size_t counted = std::accumulate(splines.counts.begin(), splines.counts.end(), size_t{0});
    if (auto problem = size_problem("points", count, counted)) return problem;
    if (auto problem = size_problem("handles", splines.handles.size(), bezier ? 2 * count : 0)) return problem;
    if (!splines.radii.empty())
        if (auto problem = size_problem("radii", splines.radii.size(), count)) return problem;
    if (!splines.tilts.empty())
        if (auto problem = size_problem("tilts", splines.tilts.size(), count)) return problem;
    if (!splines.straight.empty())
        if (auto problem = size_problem("straight", splines.straight.size(), count)) return problem;
    if (splines.type == CurveSplineType::Nurbs &&
        (splines.nurbs.order < 2 || splines.nurbs.order > kLargestCurveDegree + 1))
        return bad("order", std::to_string(splines.nurbs.order), "2 to " + std::to_string(kLargestCurveDegree + 1));
    if (splines.resolution < 1 || splines.resolution > kLargestResolution)
        return bad("resolution", std::to_string(splines.resolution), "1 to " + std::to_string(kLargestResolution));
    if (splines.material_slot < 0) return bad("material_slot", std::to_string(splines.material_slot), "0 or more");
    if (auto problem = number_problem("radii", splines.radii)) return problem;
    if (auto problem = number_problem("tilts", splines.tilts)) return problem;
    return point_problem(splines);
}

void CurveSplines::add_to(ContentHasher& hasher) const {
    hasher.add(static_cast<int>(type));
    hasher.add(nurbs.order);
    hasher.add((nurbs.cyclic ? 1 : 0) + (nurbs.endpoint ? 2 : 0) + (nurbs.bezier ? 4 : 0) + (smooth ? 8 : 0) +
               (ends_at_seam ? 16 : 0));
    hasher.add(counts);
    hasher.add(points);
    hasher.add(handles);
    hasher.add(radii);
    hasher.add(tilts);
    hasher.add(straight);
    hasher.add(static_cast<int>(radius_interpolation));
    hasher.add(static_cast<int>(tilt_interpolation));
    for (const int number : {resolution, material_slot, fill_group}) hasher.add(number);
}

}  // namespace rayleaf
