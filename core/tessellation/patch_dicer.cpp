#include "tessellation/patch_dicer.h"

namespace rayleaf {

PatchDicer::PatchDicer(const PatchSurface& surface, const FacetTolerance& tolerance, int extra_splits)
    : surface_(&surface), plan_(surface, tolerance, extra_splits) {
    add_bases();
}

PatchDicer::PatchDicer(const PatchSurface& surface, const PatchDicer& like) : surface_(&surface), plan_(like.plan_) {
    add_bases();
}

void PatchDicer::add_bases() {
    for (uint32_t i = 0; i < surface_->splines().size(); ++i) {
        const SplinePatches& spline = surface_->splines()[i];
        const SplineSplit& split = plan_.split(i);
        of_spline_.push_back({level_bases(spline.degree_u, split.log2_u), level_bases(spline.degree_v, split.log2_v)});
    }
}

PatchDicer::LevelBases PatchDicer::level_bases(int degree, int log2) {
    LevelBases result{};
    for (int level = kMedium; level < kStoredLevels; ++level) {
        const int intervals = quads_along(level) << log2;
        result[level] = &bases_.try_emplace({degree, intervals}, degree, intervals).first->second;
    }
    return result;
}

void PatchDicer::dice_level(uint32_t index, int level, const VertexRows& target) const {
    const Subpatch& subpatch = plan_.subpatch(index);
    const SplineSplit& split = plan_.split(subpatch.spline);
    const SplineBases& bases = of_spline_[subpatch.spline];
    const int quads = quads_along(level);
    const auto axis = [quads](const DyadicBasis* basis, int cell, int log2) {
        return DiceAxis{basis, cell * quads, cell == 0, cell + 1 == 1 << log2};
    };
    rayleaf::dice(surface_->patch(subpatch.patch), axis(bases.u[level], subpatch.u, split.log2_u),
                  axis(bases.v[level], subpatch.v, split.log2_v), target);
}

void PatchDicer::dice_part_rows(uint32_t index, const GridPart& part, const VertexRows& target) const {
    const Subpatch& subpatch = plan_.subpatch(index);
    const SplineSplit& split = plan_.split(subpatch.spline);
    const SplinePatches& spline = surface_->splines()[subpatch.spline];
    const int parts = part.parts_along();
    // Bases of this many intervals are large and seldom used: compute only those of the part.
    const auto basis = [parts](int degree, int cell, int log2, int number) {
        return DyadicBasis(degree, (kGridCells * parts) << log2, (cell * parts + number) * kGridCells, kGridCells);
    };
    const auto axis = [parts](const DyadicBasis& of_part, int cell, int log2, int number) {
        return DiceAxis{&of_part, 0, cell == 0 && number == 0, cell + 1 == 1 << log2 && number + 1 == parts};
    };
    const DyadicBasis basis_u = basis(spline.degree_u, subpatch.u, split.log2_u, part.u);
    const DyadicBasis basis_v = basis(spline.degree_v, subpatch.v, split.log2_v, part.v);
    rayleaf::dice(surface_->patch(subpatch.patch), axis(basis_u, subpatch.u, split.log2_u, part.u),
                  axis(basis_v, subpatch.v, split.log2_v, part.v), target);
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
    size_t total = sizeof(*this) + plan_.bytes() + of_spline_.capacity() * sizeof(SplineBases);
    for (const auto& [key, basis] : bases_) total += basis.bytes();
    return total;
}

}  // namespace rayleaf
