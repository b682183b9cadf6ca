#include "trace/make_scene.h"

#include "tessellation/displaced_dicer.h"
#include "tessellation/patch_dicer.h"
#include "tessellation/subdivision_dicer.h"
#include "tessellation/swept_dicer.h"
#include "trace/embree_strand_scene.h"
#include "trace/grid_scene.h"
#include "trace/resident_scene.h"
#include "trace/strand_scene.h"
#include "trace/triangle_scene.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace rayleaf {
namespace {

/// What Embree's tree takes for each primitive, bytes, about.
constexpr uint64_t kTreeBytes = 80;

std::unique_ptr<const Dicer> dicer_of(const Shape& shape, const FacetTolerance& tolerance) {
    switch (shape.kind()) {
        case ShapeKind::PatchSurface:
            return std::make_unique<PatchDicer>(static_cast<const PatchSurface&>(shape), tolerance);
        case ShapeKind::SweptSurface:
            return std::make_unique<SweptDicer>(static_cast<const SweptSurface&>(shape), tolerance);
        case ShapeKind::DisplacedSurface:
            return std::make_unique<DisplacedDicer>(static_cast<const DisplacedSurface&>(shape), tolerance);
        case ShapeKind::SubdivisionSurface:
            return std::make_unique<SubdivisionDicer>(static_cast<const SubdivisionSurface&>(shape), tolerance);
        case ShapeKind::TriangleMesh:
        case ShapeKind::Strands:
            break;
    }
    return nullptr;
}

/// Dices a form of a shape that deforms as another dicer does.
std::unique_ptr<const Dicer> form_dicer(const Shape& shape, size_t step, const Dicer& like) {
    if (shape.kind() == ShapeKind::PatchSurface)
        return std::make_unique<PatchDicer>(static_cast<const PatchSurface&>(shape).form(step),
                                            static_cast<const PatchDicer&>(like));
    return std::make_unique<SubdivisionDicer>(static_cast<const SubdivisionSurface&>(shape).form(step),
                                              static_cast<const SubdivisionDicer&>(like));
}

std::vector<DicedSurface> diced_forms(const Shape& shape, std::unique_ptr<const Dicer> dicer,
                                      const FacetTolerance& tolerance, WaitingGrids& waiting,
                                      const CancelToken& cancel) {
    std::vector<DicedSurface> forms;
    const auto add = [&](std::unique_ptr<const Dicer> form) {
        forms.emplace_back(std::move(form), tolerance, waiting, cancel);
    };
    if (!shape.deforms())
        add(std::move(dicer));
    else
        for (size_t step = 0; step < shape.steps(); ++step) add(form_dicer(shape, step, *dicer));
    return forms;
}

double facet_distance_of(const Shape& shape, const FacetTolerance& tolerance) {
    if (shape.kind() != ShapeKind::PatchSurface) return 0.0;
    const auto& surface = static_cast<const PatchSurface&>(shape);
    double distance = 0.0;
    for (uint32_t patch = 0; patch < surface.element_count(); ++patch)
        distance = std::max(distance, tolerance(surface.patch_box(patch)));
    return distance;
}

std::unique_ptr<ShapeScene> make_plain_scene(const Shape& shape, const CancelToken& cancel) {
    if (shape.kind() == ShapeKind::TriangleMesh) {
        const auto& mesh = static_cast<const TriangleMesh&>(shape);
        if (FewTrianglesScene::suits(mesh)) return std::make_unique<FewTrianglesScene>(mesh);
        return std::make_unique<TriangleScene>(mesh, cancel);
    }
    const auto& strands = static_cast<const Strands&>(shape);
    if (strands.form() == StrandForm::EmbreeRound) return std::make_unique<EmbreeStrandScene>(strands, cancel);
    return std::make_unique<StrandScene>(strands, cancel);
}

}  // namespace

uint64_t ShapePlan::resident_bytes() const {
    if (!blocks) return 0;
    if (blocks->block_count() > kMostBlocks) return std::numeric_limits<uint64_t>::max();
    return blocks->block_count() * (blocks->block_bytes() + kTreeBytes);
}

ShapePlan plan_shape(const Shape& shape, const FacetTolerance& tolerance, WaitingGrids& waiting,
                     const CancelToken& cancel) {
    cancel.throw_if_cancelled();
    ShapePlan plan;
    plan.shape = &shape;
    // Dicers call this for every part, so it is a good place to look whether to stop.
    std::unique_ptr<const Dicer> dicer = dicer_of(shape, [&](const Box3d& box) {
        cancel.throw_if_cancelled();
        return tolerance(box);
    });
    if (!dicer) return plan;
    plan.forms = diced_forms(shape, std::move(dicer), tolerance, waiting, cancel);
    plan.blocks.emplace(diced(plan.forms), tolerance);
    plan.facet_distance = facet_distance_of(shape, tolerance);
    return plan;
}

std::unique_ptr<ShapeScene> make_scene(ShapePlan plan, Residence residence, const CancelToken& cancel) {
    cancel.throw_if_cancelled();
    if (plan.forms.empty()) return make_plain_scene(*plan.shape, cancel);
    std::unique_ptr<ShapeScene> scene;
    if (residence == Residence::Resident)
        scene = std::make_unique<ResidentScene>(*plan.shape, std::move(plan.forms), std::move(*plan.blocks), cancel);
    else
        scene = std::make_unique<GridScene>(*plan.shape, std::move(plan.forms.front()), cancel);
    scene->set_facet_distance(plan.facet_distance);
    return scene;
}

std::vector<Residence> choose_residents(std::span<const uint64_t> bytes, std::span<const uint32_t> instances,
                                        uint64_t budget) {
    std::vector<size_t> order(bytes.size());
    std::iota(order.begin(), order.end(), size_t{0});
    const auto cost = [&](size_t i) { return static_cast<double>(bytes[i]) / instances[i]; };
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return cost(a) < cost(b); });
    std::vector<Residence> chosen(bytes.size(), Residence::Cached);
    for (const size_t i : order) {
        if (bytes[i] > budget) continue;
        budget -= bytes[i];
        chosen[i] = Residence::Resident;
    }
    return chosen;
}

}  // namespace rayleaf
