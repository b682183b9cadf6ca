// Bounds of media by what is found at points of a lattice.
#include "scene/majorant_grid.h"

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// What lies between the points may be denser by this factor: fewer surprises.
constexpr float kReserve = 1.25f;
constexpr size_t kTogether = 32;

double share_of(int i, int count) {
    return count > 0 ? static_cast<double>(i) / count : 0.5;
}

using CellPoints = std::array<FoundDensity, CellDetail::kPoints>;

/// Points of a box, evenly, both ends of each side included.
struct Lattice {
    const Box3d& box;
    int last;  ///< along a side
    std::vector<FoundDensity> found;

    Lattice(const Box3d& around, int steps) : box(around), last(steps), found(layer_size() * (size_t(last) + 1)) {}
    size_t layer_size() const { return (static_cast<size_t>(last) + 1) * (static_cast<size_t>(last) + 1); }
    void fill_layer(int z, const DensityLookup& lookup) {
        std::array<Vec3d, kTogether> points;
        const Vec3d size = box.size();
        const int side = last + 1, count = side * side;
        FoundDensity* layer = found.data() + layer_size() * static_cast<size_t>(z);
        for (int first = 0; first < count; first += static_cast<int>(kTogether)) {
            const int together = std::min(static_cast<int>(kTogether), count - first);
            for (int i = 0; i < together; ++i) {
                const Vec3d share(share_of((first + i) % side, last), share_of((first + i) / side, last),
                                  share_of(z, last));
                points[static_cast<size_t>(i)] = box.min + size * share;
            }
            lookup({points.data(), static_cast<size_t>(together)}, layer + first);
        }
    }
    /// Those of a cell, its sides included.
    CellPoints points_of(int x, int y, int z) const {
        CellPoints own;
        size_t count = 0;
        for (int k = 0; k < CellDetail::kSide; ++k)
            for (int j = 0; j < CellDetail::kSide; ++j) {
                const size_t row = layer_size() * static_cast<size_t>(z * CellDetail::kSteps + k) +
                                   (static_cast<size_t>(last) + 1) * static_cast<size_t>(y * CellDetail::kSteps + j);
                for (int i = 0; i < CellDetail::kSide; ++i)
                    own[count++] = found[row + static_cast<size_t>(x * CellDetail::kSteps + i)];
            }
        return own;
    }
};

}  // namespace

BoundedCells looked_up_cells(const Box3d& box, int cells, const DensityLookup& lookup, const CancelToken& cancel) {
    Lattice lattice(box, cells * CellDetail::kSteps);
    tbb::parallel_for(0, lattice.last + 1, [&](int z) {
        cancel.throw_if_cancelled();
        lattice.fill_layer(z, lookup);
    });
    BoundedCells bounded;
    const size_t layer = static_cast<size_t>(cells) * cells;
    bounded.bounds.resize(layer * cells);
    bounded.details.resize(layer * cells);
    tbb::parallel_for(0, cells, [&](int z) {
        size_t cell = layer * static_cast<size_t>(z);
        for (int y = 0; y < cells; ++y)
            for (int x = 0; x < cells; ++x, ++cell) {
                const CellPoints points = lattice.points_of(x, y, z);
                bounded.bounds[cell] = bounds_of(points, points, kReserve);
                bounded.details[cell] = CellDetail(points, bounded.bounds[cell]);
            }
    });
    return bounded;
}

}  // namespace rayleaf
