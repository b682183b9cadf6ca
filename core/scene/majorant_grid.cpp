#include "scene/majorant_grid.h"

#include <utility>

namespace rayleaf {

GridLine::GridLine(const Vec3d& from, const Vec3d& towards) : origin(from), direction(towards), per_direction(0.0) {
    for (int axis = 0; axis < 3; ++axis)
        if (direction[axis] != 0.0) per_direction[axis] = 1.0 / direction[axis];
}

MajorantGrid::MajorantGrid(const Box3d& box, int cells, BoundedCells bounded)
    : box_(box),
      cells_(cells),
      width_(box.size() / static_cast<double>(cells)),
      per_width_(0.0),
      bounded_(std::move(bounded)) {
    for (int axis = 0; axis < 3; ++axis)
        if (width_[axis] > 0.0) per_width_[axis] = 1.0 / width_[axis];
    for (const DensityBounds& each : bounded_.bounds) largest_.majorant = std::max(largest_.majorant, each.majorant);
    largest_.residual = largest_.limit = largest_.majorant;
}

GridWalk::GridWalk(const MajorantGrid& grid, const GridLine& line, BoundDetail detail)
    : grid_(&grid), detail_(detail), bounds_(grid.largest_) {
    std::ptrdiff_t stride = 1, index = 0;
    for (int axis = 0; axis < 3; ++axis, stride *= grid.cells_) {
        if (grid.per_width_[axis] == 0.0) continue;
        // Rays begin on the border of what is bounded: as good as inside.
        constexpr double kOutside = 1e-6;
        const double place = (line.origin[axis] - grid.box_.min[axis]) * grid.per_width_[axis];
        if (!(place >= -kOutside && place <= grid.cells_ + kOutside)) return;
        const int cell = std::clamp(static_cast<int>(place), 0, grid.cells_ - 1);
        index += stride * cell;
        Axis& walk = axes_[static_cast<size_t>(axis)];
        walk.next = cell + 1;
        if (line.direction[axis] == 0.0) continue;
        const bool is_up = line.direction[axis] > 0.0;
        walk.base = (grid.box_.min[axis] - line.origin[axis]) * line.per_direction[axis];
        walk.step = grid.width_[axis] * line.per_direction[axis];
        walk.turn = is_up ? 1 : -1;
        if (!is_up) walk.next = cell;
        walk.last = is_up ? grid.cells_ : 0;
        walk.stride = is_up ? stride : -stride;
        walk.find_border();
    }
    cell_ = static_cast<size_t>(index);
    if (detail == BoundDetail::Pieces) {
        origin_ = (line.origin - grid.box_.min) * grid.per_width_ * CellDetail::kSteps;
        direction_ = line.direction * grid.per_width_ * CellDetail::kSteps;
        pieces_per_length_ = direction_.length();
    }
    enter_cell(0.0);
}

void GridWalk::enter_cell(double t) {
    // Detail of what hardly dims light costs more than it saves: optical depth.
    constexpr double kLeastSaved = 0.02;
    cell_end_ = end_ = std::min({axes_[0].border, axes_[1].border, axes_[2].border});
    bounds_ = grid_->bounded_.bounds[cell_];
    pieces_.count = 0;
    if (detail_ == BoundDetail::Cells) return;
    const CellDetail& detail = grid_->bounded_.details[cell_];
    const double length = cell_end_ - t;
    if (detail.is_none() || !(static_cast<double>(bounds_.residual - detail.residual()) * length > kLeastSaved)) return;
    const double count = std::clamp(std::ceil(length * pieces_per_length_), 1.0, static_cast<double>(kMostPieces));
    pieces_.passed = 0;
    pieces_.count = static_cast<int>(count);
    pieces_.begin = t;
    pieces_.length = length / count;
    for (int axis = 0; axis < 3; ++axis) {
        const double corner = CellDetail::kSteps * axes_[static_cast<size_t>(axis)].cell();
        pieces_.all.begin[static_cast<size_t>(axis)] =
            static_cast<float>(origin_[axis] + direction_[axis] * t - corner);
        pieces_.all.step[static_cast<size_t>(axis)] = static_cast<float>(direction_[axis] * pieces_.length);
    }
    detail.look_up(pieces_.all);
    enter_piece();
}

void GridWalk::enter_piece() {
    const float share = pieces_.all.shares[static_cast<size_t>(pieces_.passed)];
    bounds_ = grid_->bounded_.details[cell_].bounds(grid_->bounded_.bounds[cell_], share);
    ++pieces_.passed;
    end_ = pieces_.passed == pieces_.count ? cell_end_ : pieces_.begin + pieces_.length * pieces_.passed;
}

void GridWalk::advance() {
    if (std::isinf(end_)) return;
    if (pieces_.passed < pieces_.count) return enter_piece();
    const double t = cell_end_;
    Axis& walk = axes_[axes_[0].border <= t ? 0 : axes_[1].border <= t ? 1 : 2];
    if (walk.next == walk.last) {
        bounds_ = grid_->largest_;
        pieces_.count = 0;
        cell_end_ = end_ = std::numeric_limits<double>::infinity();
        return;
    }
    walk.next += walk.turn;
    walk.find_border();
    cell_ = static_cast<size_t>(static_cast<std::ptrdiff_t>(cell_) + walk.stride);
    enter_cell(t);
}

}  // namespace rayleaf
