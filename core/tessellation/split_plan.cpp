#include "tessellation/split_plan.h"

#include <algorithm>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// Bounds of rational patches are loose where weights vary, and tighten with the square of the patch's size. So they
/// are computed for this many parts in each direction.
constexpr int kRationalParts = 4;

CurvatureBounds tight_curvature_bounds(const PatchView& patch) {
    if (!patch.rational) return curvature_bounds(patch);
    const BezierPatch whole = BezierPatch::copy_of(patch);
    constexpr double kSize = 1.0 / kRationalParts;
    CurvatureBounds bounds;
    for (int j = 0; j < kRationalParts; ++j) {
        for (int i = 0; i < kRationalParts; ++i) {
            const BezierPatch part = whole.restricted(i * kSize, (i + 1) * kSize, j * kSize, (j + 1) * kSize);
            const CurvatureBounds here = curvature_bounds(part.view());
            bounds.duu = std::max(bounds.duu, here.duu / (kSize * kSize));
            bounds.duv = std::max(bounds.duv, here.duv / (kSize * kSize));
            bounds.dvv = std::max(bounds.dvv, here.dvv / (kSize * kSize));
        }
    }
    bounds.extent = curvature_bounds(patch).extent;
    return bounds;
}

}  // namespace

/// Splits in the direction with the larger bend until the facets are near enough.
SplineSplit split_for(const CurvatureBounds& bounds, double tolerance) {
    SplineSplit split;
    while (facet_distance_bound(bounds, split.cells_u(), split.cells_v()) > tolerance) {
        const double bend_u = bounds.duu / (double(split.cells_u()) * split.cells_u());
        const double bend_v = bounds.dvv / (double(split.cells_v()) * split.cells_v());
        const bool can_u = split.log2_u < kMostLog2, can_v = split.log2_v < kMostLog2;
        if (!can_u && !can_v) break;
        // Twist bends neither direction, so both are halved in turn.
        const bool prefer_u = bend_u != bend_v ? bend_u > bend_v : split.log2_u <= split.log2_v;
        if (can_u && (prefer_u || !can_v))
            ++split.log2_u;
        else
            ++split.log2_v;
    }
    return split;
}

SplitPlan::SplitPlan(const PatchSurface& surface, const FacetTolerance& tolerance, int extra_splits) {
    const size_t count = surface.element_count();
    std::vector<SplineSplit> wanted(count);
    tbb::parallel_for(size_t{0}, count, [&](size_t i) {
        const auto patch = static_cast<uint32_t>(i);
        const double allowed = tolerance(surface.patch_box(patch));
        CurvatureBounds bounds;
        for (size_t step = 0; step < surface.steps(); ++step)
            bounds.raise_to(tight_curvature_bounds(surface.form(step).patch(patch)));
        wanted[i] = split_for(bounds, allowed);
    });
    for (const SplinePatches& spline : surface.splines()) {
        SplineSplit split;
        for (uint32_t i = 0; i < spline.patch_count(); ++i) {
            split.log2_u = std::max(split.log2_u, wanted[spline.first_patch + i].log2_u);
            split.log2_v = std::max(split.log2_v, wanted[spline.first_patch + i].log2_v);
        }
        split.log2_u = std::min(split.log2_u + extra_splits, kMostLog2);
        split.log2_v = std::min(split.log2_v + extra_splits, kMostLog2);
        splits_.push_back(split);
    }
    SharedSides sides(surface);
    std::vector<int> most(2 * splits_.size());  // by group
    for (size_t i = 0; i < splits_.size(); ++i)
        for (const int axis : {0, 1}) {
            int& of_group = most[sides.group(i, axis)];
            of_group = std::max(of_group, splits_[i].log2(axis));
        }
    for (size_t i = 0; i < splits_.size(); ++i)
        for (const int axis : {0, 1}) splits_[i].log2(axis) = most[sides.group(i, axis)];
    limit(surface, sides);
    number(surface);
}

uint64_t SplitPlan::subpatches_wanted(const PatchSurface& surface) const {
    uint64_t sum = 0;
    for (size_t i = 0; i < splits_.size(); ++i)
        sum += uint64_t{surface.splines()[i].patch_count()} << (splits_[i].log2_u + splits_[i].log2_v);
    return sum;
}

/// Undoes the finest splits until the number of subpatches is within the limit.
void SplitPlan::limit(const PatchSurface& surface, SharedSides& sides) {
    while (subpatches_wanted(surface) > kMostSubpatches) {
        const auto finest = std::max_element(splits_.begin(), splits_.end(), [](const auto& a, const auto& b) {
            return a.log2_u + a.log2_v < b.log2_u + b.log2_v;
        });
        const int larger = finest->log2_u >= finest->log2_v ? 0 : 1;
        if (finest->log2(larger) == 0) return;
        const uint32_t group = sides.group(static_cast<size_t>(finest - splits_.begin()), larger);
        for (size_t i = 0; i < splits_.size(); ++i)
            for (const int axis : {0, 1})
                if (sides.group(i, axis) == group) --splits_[i].log2(axis);
    }
}

void SplitPlan::number(const PatchSurface& surface) {
    subpatches_.reserve(subpatches_wanted(surface));
    for (uint32_t spline = 0; spline < splits_.size(); ++spline) {
        SplineSplit& split = splits_[spline];
        split.first_subpatch = subpatch_count();
        const SplinePatches& patches = surface.splines()[spline];
        for (uint32_t patch = 0; patch < patches.patch_count(); ++patch) {
            for (int v = 0; v < 1 << split.log2_v; ++v) {
                for (int u = 0; u < 1 << split.log2_u; ++u)
                    subpatches_.push_back({patches.first_patch + patch, spline, u, v});
            }
        }
    }
}

uint32_t SplitPlan::index_at(const PatchSurface& surface, uint32_t patch, double u, double v) const {
    const SplinePatches& spline = surface.spline_of(patch);
    const SplineSplit& split = splits_[static_cast<size_t>(&spline - surface.splines().data())];
    const auto cell = [](double parameter, int log2) {
        const int count = 1 << log2;
        return static_cast<uint32_t>(std::clamp(static_cast<int>(parameter * count), 0, count - 1));
    };
    const uint32_t number = (patch - spline.first_patch) << (split.log2_u + split.log2_v);
    return split.first_subpatch + number + (cell(v, split.log2_v) << split.log2_u) + cell(u, split.log2_u);
}

}  // namespace rayleaf
