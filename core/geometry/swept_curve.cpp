#include "geometry/swept_curve.h"

#include "base/largest.h"

#include <span>

namespace rayleaf {
namespace {

std::optional<SplineProblem> number_problem(const char* argument, double value, double least, double most) {
    if (value >= least && value <= most) return std::nullopt;
    return SplineProblem{SplineProblemKind::BadData, argument, number_text(value),
                         "a number from " + number_text(least) + " to " + number_text(most)};
}

std::optional<SplineProblem> splines_problem(const std::string& argument, const std::vector<CurveSplines>& splines) {
    for (size_t i = 0; i < splines.size(); ++i) {
        std::optional<SplineProblem> problem = find_problem(splines[i]);
        if (!problem) continue;
        problem->argument = argument + '[' + std::to_string(i) + "]." + problem->argument;
        return problem;
    }
    return std::nullopt;
}

std::optional<SplineProblem> fill_problem(const SweptCurveDescription& curve) {
    if (curve.fill_materials.empty()) return std::nullopt;
    if (curve.dimensions != CurveDimensions::Two)
        return SplineProblem{SplineProblemKind::BadData, "fill_materials", "those of a curve in 3D", "none, or 2D"};
    constexpr int kMostSlots = 1 << 16;
    for (const int slot : curve.fill_materials)
        if (auto problem = number_problem("fill_materials", slot, 0, kMostSlots)) return problem;
    for (const CurveSplines& splines : curve.splines)
        if (auto problem = number_problem("splines.fill_group", splines.fill_group, 0,
                                          static_cast<double>(curve.fill_materials.size()) - 1))
            return problem;
    return std::nullopt;
}

}  // namespace

std::optional<SplineProblem> find_problem(const SweptCurveDescription& curve) {
    /// Blender's panel allows up to 32.
    constexpr double kMostPieces = 1 << 16;
    if (auto problem = number_problem("bevel_depth", curve.bevel_depth, -kLargestLength, kLargestLength))
        return problem;
    if (auto problem = number_problem("extrude", curve.extrude, -kLargestLength, kLargestLength)) return problem;
    if (auto problem = number_problem("offset", curve.offset, -kLargestLength, kLargestLength)) return problem;
    if (auto problem = number_problem("bevel_resolution", curve.bevel_resolution, 0, kMostPieces)) return problem;
    if (auto problem = number_problem("bevel_start", curve.bevel_start, 0, 1)) return problem;
    if (auto problem = number_problem("bevel_end", curve.bevel_end, 0, 1)) return problem;
    if (auto problem = splines_problem("splines", curve.splines)) return problem;
    if (auto problem = fill_problem(curve)) return problem;
    if (curve.profile)
        if (auto problem = splines_problem("profile", *curve.profile)) return problem;
    if (curve.taper)
        if (auto problem = splines_problem("taper", {*curve.taper})) return problem;
    return std::nullopt;
}

void SweptCurveDescription::add_to(ContentHasher& hasher) const {
    const auto add_splines = [&hasher](std::span<const CurveSplines> all) {
        hasher.add(static_cast<uint64_t>(all.size()));
        for (const CurveSplines& each : all) each.add_to(hasher);
    };
    add_splines(splines);
    for (const int choice : {static_cast<int>(dimensions), static_cast<int>(twist), static_cast<int>(closed_twist),
                             static_cast<int>(fill), static_cast<int>(taper_radius), static_cast<int>(start_mapping),
                             static_cast<int>(end_mapping), bevel_resolution})
        hasher.add(choice);
    for (const double number : {bevel_depth, extrude, offset, bevel_start, bevel_end}) hasher.add(number);
    hasher.add((profile ? 1 : 0) + (taper ? 2 : 0) + (taper_fits_bevel ? 4 : 0) + (fill_caps ? 8 : 0));
    if (profile) add_splines(*profile);
    if (taper) taper->add_to(hasher);
    hasher.add(fill_materials);
}

}  // namespace rayleaf
