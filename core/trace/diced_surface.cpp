#include "trace/diced_surface.h"

#include "tessellation/grid_measure.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

namespace rayleaf {
namespace {

Box3f box_of(const GridMeasure& measure, float padding) {
    Box3f box;
    for (int axis = 0; axis < 3; ++axis) {
        box.min[axis] = measure.low[axis] - padding;
        box.max[axis] = measure.high[axis] + padding;
    }
    return box;
}

void measure_subpatch(DicedSurface& surface, uint32_t subpatch, const FacetTolerance& tolerance,
                      WaitingGrids& waiting) {
    const LevelDicer* levels = surface.dicer->levels();
    if (!levels) {
        const SubpatchBounds bounds = surface.dicer->bounds(subpatch);
        surface.tubes[subpatch] = bounds.tube;
        surface.boxes[subpatch] = bounds.box;
        return;
    }
    GridRows rows;
    levels->dice_rows(subpatch, rows);
    const GridMeasure measure = measure_grid(rows);
    const SubpatchDetail& detail = surface.details[subpatch] = detail_of(rows, measure);
    surface.boxes[subpatch] = box_of(measure, kBlockPadding + kPartDistance * fine_facet_distance(detail));
    if (!levels->is_slow()) return;
    const DicedForm form{levels, surface.details, {}};
    if (resolution_for({&form, 1}, subpatch, tolerance).needs_fine_grid() && waiting.take())
        surface.grids[subpatch] = std::make_unique<const GridRows>(rows);
}

}  // namespace

DicedSurface::DicedSurface(std::unique_ptr<const Dicer> made_of, const FacetTolerance& tolerance, WaitingGrids& waiting,
                           const CancelToken& cancel)
    : dicer(std::move(made_of)) {
    const uint32_t count = dicer->subpatch_count();
    boxes.resize(count);
    if (dicer->levels()) {
        details.resize(count);
        if (dicer->levels()->is_slow()) grids.resize(count);
    } else {
        tubes.resize(count);
    }
    box = tbb::parallel_reduce(
        tbb::blocked_range<uint32_t>(0, count), Box3f(),
        [&](const tbb::blocked_range<uint32_t>& range, Box3f part) {
            for (uint32_t i = range.begin(); i < range.end(); ++i) {
                cancel.throw_if_cancelled();
                measure_subpatch(*this, i, tolerance, waiting);
                part.extendBy(boxes[i]);
            }
            return part;
        },
        [](Box3f a, const Box3f& b) {
            a.extendBy(b);
            return a;
        });
}

std::vector<DicedForm> diced(const std::vector<DicedSurface>& forms) {
    std::vector<DicedForm> all;
    all.reserve(forms.size());
    for (const DicedSurface& form : forms) all.push_back({form.dicer.get(), form.details, form.grids});
    return all;
}

}  // namespace rayleaf
