#include "trace/make_scene.h"

#include "splines/bounds.h"
#include "tessellation/displaced_dicer.h"
#include "tessellation/patch_dicer.h"
#include "tessellation/subdivision_dicer.h"
#include "tessellation/swept_dicer.h"
#include "trace/embree_strand_scene.h"
#include "trace/grid_scene.h"
#include "trace/strand_scene.h"
#include "trace/triangle_scene.h"

namespace rayleaf {
namespace {

std::unique_ptr<ShapeScene> make_patch_scene(const PatchSurface& surface, const FacetTolerance& tolerance,
                                             const CancelToken& cancel) {
    auto scene = std::make_unique<GridScene>(surface, std::make_unique<PatchDicer>(surface, tolerance), cancel);
    double distance = 0.0;
    for (uint32_t patch = 0; patch < surface.element_count(); ++patch)
        distance = std::max(distance, tolerance(hull_bounds(surface.patch(patch))));
    scene->set_facet_distance(distance);
    return scene;
}

}  // namespace

std::unique_ptr<ShapeScene> make_scene(const Shape& shape, const FacetTolerance& tolerance, const CancelToken& cancel) {
    cancel.throw_if_cancelled();
    if (shape.kind() == ShapeKind::TriangleMesh)
        return std::make_unique<TriangleScene>(static_cast<const TriangleMesh&>(shape), cancel);
    if (shape.kind() == ShapeKind::Strands) {
        const auto& strands = static_cast<const Strands&>(shape);
        if (strands.form() == StrandForm::EmbreeRound) return std::make_unique<EmbreeStrandScene>(strands, cancel);
        return std::make_unique<StrandScene>(strands, cancel);
    }
    if (shape.kind() == ShapeKind::PatchSurface)
        return make_patch_scene(static_cast<const PatchSurface&>(shape), tolerance, cancel);
    std::unique_ptr<const Dicer> dicer;
    if (shape.kind() == ShapeKind::SweptSurface)
        dicer = std::make_unique<SweptDicer>(static_cast<const SweptSurface&>(shape), tolerance);
    else if (shape.kind() == ShapeKind::DisplacedSurface)
        dicer = std::make_unique<DisplacedDicer>(static_cast<const DisplacedSurface&>(shape), tolerance);
    else
        dicer = std::make_unique<SubdivisionDicer>(static_cast<const SubdivisionSurface&>(shape), tolerance);
    return std::make_unique<GridScene>(shape, std::move(dicer), cancel);
}

}  // namespace rayleaf
