#include "tessellation/patch_dicer.h"

#include "tessellation/dice.h"

namespace rayleaf {

PatchDicer::PatchDicer(const PatchSurface& surface, const FacetTolerance& tolerance)
    : Dicer(VertexFormat::Float), surface_(&surface), plan_(surface, tolerance) {
    for (uint32_t i = 0; i < surface.splines().size(); ++i) {
        const SplinePatches& spline = surface.splines()[i];
        const SplineSplit& split = plan_.split(i);
        for (const auto& [degree, cells] :
             {std::pair(spline.degree_u, split.cells_u()), std::pair(spline.degree_v, split.cells_v())})
            bases_.try_emplace({degree, cells}, degree, cells);
    }
}

void PatchDicer::dice(uint32_t index, Grid& grid) const {
    const Subpatch& subpatch = plan_.subpatch(index);
    const SplineSplit& split = plan_.split(subpatch.spline);
    const SplinePatches& spline = surface_->splines()[subpatch.spline];
    rayleaf::dice(surface_->patch(subpatch.patch), bases_.at({spline.degree_u, split.cells_u()}),
                  subpatch.u * kGridCells, bases_.at({spline.degree_v, split.cells_v()}), subpatch.v * kGridCells,
                  grid);
}

ElementPlace PatchDicer::element_place(const PlaceInGrid& place, const Vec3d&) const {
    const Subpatch& subpatch = plan_.subpatch(place.subpatch);
    const SplineSplit& split = plan_.split(subpatch.spline);
    return {subpatch.patch, static_cast<float>((subpatch.u * kGridCells + place.at.x) / split.cells_u()),
            static_cast<float>((subpatch.v * kGridCells + place.at.y) / split.cells_v())};
}

std::optional<PlaceInGrid> PatchDicer::place_in_grid(const ElementPlace& place) const {
    const uint32_t index = plan_.index_at(*surface_, place.element, place.u, place.v);
    const Subpatch& subpatch = plan_.subpatch(index);
    const SplineSplit& split = plan_.split(subpatch.spline);
    return PlaceInGrid{index, Vec2d(double{place.u} * split.cells_u() - subpatch.u * kGridCells,
                                    double{place.v} * split.cells_v() - subpatch.v * kGridCells)};
}

size_t PatchDicer::bytes() const {
    size_t total = sizeof(*this) + subpatch_count() * sizeof(Subpatch);
    for (const auto& [key, basis] : bases_)
        total += sizeof(basis) + (key.first + size_t{1}) * (key.second + size_t{1}) * sizeof(float);
    return total;
}

}  // namespace rayleaf
