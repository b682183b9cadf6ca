#include "tessellation/displaced_dicer.h"

#include "tessellation/dice.h"
#include "tessellation/patch_dicer.h"
#include "tessellation/subdivision_dicer.h"

#include <algorithm>
#include <atomic>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// A displacement alone does not raise the number of subpatches above this (a million quads); the base surface may.
constexpr uint32_t kMostDisplacedSubpatches = 1u << 12;
/// The most additional splits of the base surface.
constexpr int kMostExtraSplits = 6;
/// The number of subpatches by which a split is judged.
constexpr uint32_t kDisplacementLooks = 64;

std::unique_ptr<const Dicer> dicer_below(const DisplacedSurface& surface, const FacetTolerance& tolerance, int extra) {
    const LocalFrame &frame = surface.frame(), &below = surface.base().frame();
    const double scale = frame.scale / below.scale;
    const FacetTolerance of_base = [&](const Box3d& box) {
        const Vec3d move = below.center - frame.center;
        return tolerance({(box.min * below.scale + move) / frame.scale, (box.max * below.scale + move) / frame.scale}) *
               scale;
    };
    if (surface.base().kind() == ShapeKind::PatchSurface)
        return std::make_unique<PatchDicer>(static_cast<const PatchSurface&>(surface.base()), of_base, extra);
    return std::make_unique<SubdivisionDicer>(static_cast<const SubdivisionSurface&>(surface.base()), of_base, extra);
}

}  // namespace

DisplacedDicer::DisplacedDicer(const DisplacedSurface& surface, const FacetTolerance& tolerance)
    : surface_(&surface), below_(dicer_below(surface, tolerance, 0)) {
    for (int extra = 1; extra <= kMostExtraSplits && !is_fine_enough(tolerance); ++extra) {
        std::unique_ptr<const Dicer> finer = dicer_below(surface, tolerance, extra);
        if (finer->subpatch_count() > kMostDisplacedSubpatches) return;
        below_ = std::move(finer);
    }
}

bool DisplacedDicer::is_fine_enough(const FacetTolerance& tolerance) const {
    const uint32_t count = subpatch_count(), looks = std::min(count, kDisplacementLooks);
    std::atomic<bool> fine{true};  // read when all tasks have ended
    tbb::parallel_for(uint32_t{0}, looks, [&](uint32_t i) {
        GridRows rows;
        dice_rows(static_cast<uint32_t>(uint64_t{i} * count / looks), rows);
        const GridMeasure measure = measure_grid(rows);
        const auto &low = measure.low, &high = measure.high;
        const Box3d box(Vec3d(low[0], low[1], low[2]), Vec3d(high[0], high[1], high[2]));
        if (fine_facet_distance(detail_of(rows, measure)) > tolerance(box)) fine = false;
    });
    return fine;
}

/// Vertices at the places `first` + `step` k of a subpatch's fine grid, column by column. Vertices on a border of the
/// element may belong to another one.
void DisplacedDicer::dice_from(uint32_t subpatch, const Vec2d& first, double step, const VertexRows& target) const {
    const int count = target.quads + 1;
    const auto on_border = [](float at) { return at == 0.0f || at == 1.0f; };
    for (int i = 0; i < count; ++i) {
        ElementPlace places[kGridVertices];
        float v[kGridVertices];
        Vec3d positions[kGridVertices];
        for (int j = 0; j < count; ++j) {
            places[j] = below_->element_place({subpatch, first + Vec2d(i, j) * step}, Vec3d(0.0));
            v[j] = places[j].v;
        }
        const auto& [element, u, lowest] = places[0];
        int begin = 0, end = 0;
        if (!on_border(u)) {
            begin = on_border(lowest) ? 1 : 0;
            end = on_border(v[count - 1]) ? count - 1 : count;
            surface_->line_positions(element, u, {v + begin, v + end}, positions + begin);
        }
        for (int j = 0; j < count; ++j) {
            if (j < begin || j >= end) positions[j] = surface_->position(element, {u, v[j]});
            for (int axis = 0; axis < 3; ++axis)
                target.axes[axis][j * count + i] = static_cast<float>(positions[j][axis]);
        }
    }
}

void DisplacedDicer::dice_level(uint32_t subpatch, int level, const VertexRows& target) const {
    dice_from(subpatch, Vec2d(0.0), quads_along(kFine - level), target);
}

void DisplacedDicer::dice_part_rows(uint32_t subpatch, const GridPart& part, const VertexRows& target) const {
    const double step = 1.0 / part.parts_along();
    dice_from(subpatch, Vec2d(part.u, part.v) * (kGridCells * step), step, target);
}

}  // namespace rayleaf
