#include "tessellation/ring_splits.h"

#include "base/joined_sets.h"
#include "tessellation/split_plan.h"

#include <algorithm>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// How much an element bends at most, and around it.
struct ElementLook {
    CurvatureBounds bounds;
    Box3d box;
};

/// Points along a side of an irregular element by which its bend is measured.
constexpr int kRingLooks = 5;

/// By differences. At an irregular corner the derivatives themselves are unbounded.
struct RingLook : ElementLook {
    RingLook(const SubdivisionSurface& surface, uint32_t element) {
        Vec3d p[kRingLooks][kRingLooks];
        for (int j = 0; j < kRingLooks; ++j) {
            for (int i = 0; i < kRingLooks; ++i) {
                p[j][i] = surface.position(element, i / (kRingLooks - 1.0), j / (kRingLooks - 1.0));
                box.extendBy(p[j][i]);
            }
        }
        constexpr int kLastLook = kRingLooks - 1;
        constexpr double kPerDifference = kLastLook * kLastLook;
        for (int j = 0; j < kRingLooks; ++j) {
            for (int i = 0; i < kRingLooks; ++i) {
                if (i > 0 && i < kLastLook)
                    bounds.duu = std::max(bounds.duu, (p[j][i - 1] + p[j][i + 1] - p[j][i] * 2.0).length());
                if (j > 0 && j < kLastLook)
                    bounds.dvv = std::max(bounds.dvv, (p[j - 1][i] + p[j + 1][i] - p[j][i] * 2.0).length());
                if (i < kLastLook && j < kLastLook)
                    bounds.duv = std::max(bounds.duv, (p[j][i] + p[j + 1][i + 1] - p[j][i + 1] - p[j + 1][i]).length());
            }
        }
        bounds.duu *= kPerDifference;
        bounds.duv *= kPerDifference;
        bounds.dvv *= kPerDifference;
        bounds.extent = (box.max - box.min).length();
    }
};

ElementLook look_at(const SubdivisionSurface& surface, uint32_t index) {
    const SubdivisionElement& element = surface.element(index);
    if (element.net == SubdivisionElement::kIrregular) return RingLook(surface, index);
    const PatchView net = surface.net(element);
    return {curvature_bounds(net), hull_bounds(net)};
}

SplineSplit wanted_split(const SubdivisionSurface& surface, uint32_t index, const FacetTolerance& tolerance) {
    ElementLook look;
    for (size_t step = 0; step < surface.steps(); ++step) {
        const ElementLook now = look_at(surface.form(step), index);
        look.bounds.raise_to(now.bounds);
        look.box.extendBy(now.box);
    }
    return split_for(look.bounds, tolerance(look.box));
}

}  // namespace

RingSplits::RingSplits(const SubdivisionSurface& surface, const FacetTolerance& tolerance, int extra_splits)
    : splits_(surface.element_count()) {
    std::vector<SplineSplit> wanted(splits_.size());
    tbb::parallel_for(size_t{0}, wanted.size(),
                      [&](size_t i) { wanted[i] = wanted_split(surface, static_cast<uint32_t>(i), tolerance); });
    JoinedSets rings(surface.line_count());
    for (uint32_t i = 0; i < splits_.size(); ++i) {
        const SubdivisionElement& element = surface.element(i);
        rings.join(element.lines[0], element.lines[2]);
        rings.join(element.lines[1], element.lines[3]);
    }
    std::vector<uint8_t> of_ring(surface.line_count());
    const auto along = [&](uint32_t element, int border) -> uint8_t& {
        return of_ring[rings.root(surface.element(element).lines[static_cast<size_t>(border)])];
    };
    for (uint32_t i = 0; i < splits_.size(); ++i) {
        along(i, 0) = std::max(along(i, 0), static_cast<uint8_t>(wanted[i].log2_u));
        along(i, 1) = std::max(along(i, 1), static_cast<uint8_t>(wanted[i].log2_v));
    }
    for (uint32_t i = 0; i < splits_.size(); ++i) {
        splits_[i].log2_u = static_cast<uint8_t>(std::min(along(i, 0) + extra_splits, kMostLog2));
        splits_[i].log2_v = static_cast<uint8_t>(std::min(along(i, 1) + extra_splits, kMostLog2));
    }
    limit();
    number();
}

/// Undoes the finest splits until the number of subpatches is within the limit.
void RingSplits::limit() {
    const auto total = [this] {
        uint64_t sum = 0;
        for (const Split& split : splits_) sum += uint64_t{1} << (split.log2_u + split.log2_v);
        return sum;
    };
    uint8_t finest = 0;
    for (const Split& split : splits_) finest = std::max({finest, split.log2_u, split.log2_v});
    while (finest > 0 && total() > kMostSubpatches) {
        --finest;
        for (Split& split : splits_) {
            split.log2_u = std::min(split.log2_u, finest);
            split.log2_v = std::min(split.log2_v, finest);
        }
    }
}

void RingSplits::number() {
    for (uint32_t element = 0; element < splits_.size(); ++element) {
        Split& split = splits_[element];
        split.first = subpatch_count();
        for (int v = 0; v < 1 << split.log2_v; ++v)
            for (int u = 0; u < 1 << split.log2_u; ++u) cells_.push_back({element, u, v});
    }
}

}  // namespace rayleaf
