#include "scene/grid_majorants.h"

#include "shading/program.h"

#include <algorithm>
#include <array>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// The first probes of a cell go through the ranges step by step.
constexpr int kRangeSteps = 8;
static_assert(CellDetail::kPoints % kMostPoints == 0);
/// Ends of so many grids are tried in all combinations.
constexpr int kCombined = 4;
constexpr int kCombinations = 1 << kCombined;
/// Between the probes there may be more, by this factor.
constexpr float kProbeReserve = 1.1f;

/// Evenly over [0, 1), by multiples of an irrational number.
double spread_number(int i, double irrational) {
    const double x = 0.5 + i * irrational;
    return x - std::floor(x);
}

/// Places in a cell: Roberts 2018, "The Unreasonable Effectiveness of Quasirandom Sequences", in three dimensions.
Vec3d place_in_cell(int probe) {
    return {spread_number(probe, 0.8191725133961645), spread_number(probe, 0.6710436067037893),
            spread_number(probe, 0.5497004779019703)};
}

/// Where in its range the grid of a number is in a probe.
float share_of_range(int probe, int grid) {
    if (probe < kRangeSteps) return static_cast<float>(probe) / (kRangeSteps - 1);
    if (probe < kRangeSteps + kCombinations && grid < kCombined)
        return static_cast<float>((probe - kRangeSteps) >> grid & 1);
    return static_cast<float>(spread_number(probe * (grid + 1), 0.6180339887498949));
}

class GridBounds {
  public:
    GridBounds(const VolumeGrids& grids, std::span<const AttributeId> read, const Box3d& box, int cells)
        : box_(box), cells_(cells), held_(count(), 0) {
        if (grids.body != VolumeBody::Blocks)
            std::ranges::fill(held_, uint8_t{1});
        else
            for (const NamedGrid& each : grids.grids) each.grid->mark_held(box, cells, held_);
        for (const AttributeId id : read)
            if (const VoxelGrid* grid = grids.find(id)) {
                ids_.push_back(id);
                ranges_.emplace_back(count());
                grid->widen_ranges(box, cells, ranges_.back());
            }
    }
    size_t count() const { return static_cast<size_t>(cells_) * cells_ * cells_; }
    bool is_held(size_t cell) const { return held_[cell] != 0; }

    /// At one of CellDetail's points, with what the grids do hold.
    GridProbe shown(size_t cell, size_t point) const {
        constexpr int kSide = CellDetail::kSide;
        const auto number = static_cast<int>(point);
        const Vec3i place(number % kSide, number / kSide % kSide, number / (kSide * kSide));
        return at(cell, Vec3d(place) / CellDetail::kSteps);
    }
    GridProbe probe(size_t cell, int number) const {
        GridProbe probe = at(cell, place_in_cell(number));
        for (size_t i = 0; i < ids_.size(); ++i) {
            const VoxelRange& range = ranges_[i][cell];
            const float share = share_of_range(number, static_cast<int>(i));
            const Vec4f value = range.least * (1.0f - share) + range.most * share;
            probe.assumed.push_back({ids_[i], {value.x, value.y, value.z, value.w}});
        }
        return probe;
    }

  private:
    Box3d box_;
    int cells_;
    std::vector<uint8_t> held_;
    std::vector<AttributeId> ids_;
    std::vector<std::vector<VoxelRange>> ranges_;  ///< by grid, then by cell

    /// `place`: in the cell, 0 to 1.
    GridProbe at(size_t cell, const Vec3d& place) const {
        const auto number = static_cast<int>(cell);
        const Vec3i first(number % cells_, number / cells_ % cells_, number / (cells_ * cells_));
        return {box_.min + box_.size() * (Vec3d(first) + place) / static_cast<double>(cells_), {}};
    }
};

}  // namespace

BoundedCells grid_majorants(const VolumeGrids& grids, std::span<const AttributeId> read, const Box3d& box, int cells,
                            const ProbeLookup& lookup, const CancelToken& cancel) {
    const GridBounds bounds(grids, read, box, cells);
    BoundedCells all{std::vector<DensityBounds>(bounds.count(), DensityBounds::none()),
                     std::vector<CellDetail>(bounds.count())};
    tbb::parallel_for(size_t{0}, bounds.count(), [&](size_t cell) {
        if (!bounds.is_held(cell)) return;
        cancel.throw_if_cancelled();
        std::array<GridProbe, kMostPoints> probes;
        std::array<FoundDensity, kMostPoints + CellDetail::kPoints> found;
        const std::span<FoundDensity, CellDetail::kPoints> shown = std::span(found).last<CellDetail::kPoints>();
        for (size_t i = 0; i < kMostPoints; ++i) probes[i] = bounds.probe(cell, static_cast<int>(i));
        lookup(probes, found.data());
        for (size_t first = 0; first < CellDetail::kPoints; first += kMostPoints) {
            for (size_t i = 0; i < kMostPoints; ++i) probes[i] = bounds.shown(cell, first + i);
            lookup(probes, shown.data() + first);
        }
        all.bounds[cell] = bounds_of(found, shown, kProbeReserve);
        all.details[cell] = CellDetail(shown, all.bounds[cell]);
    });
    return all;
}

}  // namespace rayleaf
