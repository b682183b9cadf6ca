#include "tessellation/subdivision_dicer.h"

#include <algorithm>

namespace rayleaf {
namespace {

constexpr int kDegree = 3;

/// The borders of an irregular element as a bicubic patch, as far as they are cubic; the rest of it is meaningless.
std::array<Vec4d, 16> frame_of(const SubdivisionSurface& surface, const SubdivisionElement& element) {
    const auto homogeneous_node = [&](size_t corner) {
        const Vec3d& p = surface.node(element.nodes[corner]);
        return Vec4d(p.x, p.y, p.z, 1.0);
    };
    std::array<Vec4d, 16> points;
    points.fill(homogeneous_node(0));
    points[3] = homogeneous_node(1);
    points[12] = homogeneous_node(2);
    points[15] = homogeneous_node(3);
    constexpr int kFirst[kBorders] = {1, 7, 13, 4}, kStep[kBorders] = {1, 4, 1, 4};
    for (size_t border = 0; border < kBorders; ++border) {
        const SubdivisionLine& line = surface.line(element.lines[border]);
        if (!line.cubic) continue;
        const bool reversed = surface.is_reversed(element, static_cast<int>(border));
        for (size_t k = 0; k < 2; ++k) {
            const Vec3d& p = line.inner[reversed ? 1 - k : k];
            points[static_cast<size_t>(kFirst[border]) + k * static_cast<size_t>(kStep[border])] =
                Vec4d(p.x, p.y, p.z, 1.0);
        }
    }
    return points;
}

}  // namespace

SubdivisionDicer::SubdivisionDicer(const SubdivisionSurface& surface, const FacetTolerance& tolerance, int extra_splits)
    : surface_(&surface), splits_(surface, tolerance, extra_splits) {
    for (uint32_t i = 0; i < surface.element_count(); ++i)
        for (const int log2 : {splits_.log2_u(i), splits_.log2_v(i)})
            for (int level = kMedium; level < kStoredLevels; ++level)
                bases_.try_emplace(quads_along(level) << log2, kDegree, quads_along(level) << log2);
}

SubdivisionDicer::SubdivisionDicer(const SubdivisionSurface& surface, const SubdivisionDicer& like)
    : surface_(&surface), splits_(like.splits_), bases_(like.bases_) {}

void SubdivisionDicer::dice_level(uint32_t subpatch, int level, const VertexRows& target) const {
    const ElementCell& cell = splits_.cell(subpatch);
    const int quads = quads_along(level);
    const auto span = [quads](int number, int log2) { return Span{number * quads, quads << log2}; };
    const Span u = span(cell.u, splits_.log2_u(cell.element)), v = span(cell.v, splits_.log2_v(cell.element));
    const auto axis = [&](const Span& along) {
        return DiceAxis{&bases_.at(along.intervals), along.first, along.at_begin(0), along.at_end(quads)};
    };
    dice_spans(cell.element, u, v, axis(u), axis(v), target);
}

void SubdivisionDicer::dice_spans(uint32_t index, const Span& u, const Span& v, const DiceAxis& axis_u,
                                  const DiceAxis& axis_v, const VertexRows& target) const {
    const SubdivisionElement& element = surface_->element(index);
    if (element.net != SubdivisionElement::kIrregular) {
        rayleaf::dice(surface_->net(element), axis_u, axis_v, target);
        return;
    }
    const std::array<Vec4d, 16> frame = frame_of(*surface_, element);
    rayleaf::dice({kDegree, kDegree, false, frame.data(), kDegree + 1}, axis_u, axis_v, target);
    evaluate_irregular(index, u, v, target);
}

/// Evaluates all vertices except corners and cubic borders.
void SubdivisionDicer::evaluate_irregular(uint32_t index, const Span& u, const Span& v,
                                          const VertexRows& target) const {
    const SubdivisionElement& element = surface_->element(index);
    const auto border_position = [&](int border, double at) -> std::optional<Vec3d> {
        const uint32_t line = element.lines[static_cast<size_t>(border)];
        if (surface_->line(line).cubic) return std::nullopt;
        return surface_->line_position(line, surface_->is_reversed(element, border) ? 1.0 - at : at);
    };
    const auto set = [&](int i, int j, const Vec3d& p) {
        for (int axis = 0; axis < 3; ++axis)
            target.axes[axis][j * (target.quads + 1) + i] = static_cast<float>(p[axis]);
    };
    const auto set_border = [&](int i, int j, int border, double at) {
        if (const std::optional<Vec3d> p = border_position(border, at)) set(i, j, *p);
    };
    const int below = v.at_begin(0) ? 1 : 0, above = v.at_end(target.quads) ? target.quads : target.quads + 1;
    double along[kGridVertices];
    Vec3d inside[kGridVertices];
    for (int j = below; j < above; ++j) along[j] = v.at(j);
    for (int i = 0; i <= target.quads; ++i) {
        if (u.at_begin(i) || u.at_end(i)) {
            for (int j = below; j < above; ++j) set_border(i, j, u.at_begin(i) ? 3 : 1, v.at(j));
            continue;
        }
        surface_->irregular_positions(index, u.at(i), {along + below, along + above}, inside + below);
        for (int j = below; j < above; ++j) set(i, j, inside[j]);
        if (below > 0) set_border(i, 0, 0, u.at(i));
        if (above == target.quads) set_border(i, target.quads, 2, u.at(i));
    }
}

void SubdivisionDicer::dice_part_rows(uint32_t subpatch, const GridPart& part, const VertexRows& target) const {
    const ElementCell& cell = splits_.cell(subpatch);
    const int parts = part.parts_along();
    const auto span = [parts](int number, int of_part, int log2) {
        return Span{(number * parts + of_part) * kGridCells, (kGridCells * parts) << log2};
    };
    const Span u = span(cell.u, part.u, splits_.log2_u(cell.element));
    const Span v = span(cell.v, part.v, splits_.log2_v(cell.element));
    // Bases of this many intervals are large and seldom used: compute only those of the part.
    const DyadicBasis basis_u(kDegree, u.intervals, u.first, kGridCells);
    const DyadicBasis basis_v(kDegree, v.intervals, v.first, kGridCells);
    const auto axis = [](const DyadicBasis& basis, const Span& along) {
        return DiceAxis{&basis, 0, along.at_begin(0), along.at_end(kGridCells)};
    };
    dice_spans(cell.element, u, v, axis(basis_u, u), axis(basis_v, v), target);
}

ElementPlace SubdivisionDicer::element_place(const PlaceInGrid& place, const Vec3d&) const {
    const ElementCell& cell = splits_.cell(place.subpatch);
    const auto parameter = [](int number, double at, int log2) {
        return static_cast<float>((number * kGridCells + at) / (kGridCells << log2));
    };
    return {cell.element, parameter(cell.u, place.at.x, splits_.log2_u(cell.element)),
            parameter(cell.v, place.at.y, splits_.log2_v(cell.element))};
}

std::optional<PlaceInGrid> SubdivisionDicer::place_in_grid(const ElementPlace& place) const {
    const int log2_u = splits_.log2_u(place.element), log2_v = splits_.log2_v(place.element);
    const auto number = [](float parameter, int log2) {
        const int count = 1 << log2;
        return std::clamp(static_cast<int>(parameter * static_cast<float>(count)), 0, count - 1);
    };
    const int u = number(place.u, log2_u), v = number(place.v, log2_v);
    const auto in_cell = [](float parameter, int log2, int cell) {
        return double{parameter} * (kGridCells << log2) - cell * kGridCells;
    };
    return PlaceInGrid{splits_.first_subpatch(place.element) + static_cast<uint32_t>((v << log2_u) + u),
                       Vec2d(in_cell(place.u, log2_u, u), in_cell(place.v, log2_v, v))};
}

size_t SubdivisionDicer::bytes() const {
    size_t total = sizeof(*this) + splits_.bytes();
    for (const auto& [intervals, basis] : bases_) total += basis.bytes();
    return total;
}

}  // namespace rayleaf
