#include "scene/majorant_grid.h"

#include <array>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

/// Lattice points along a side of a cell, those of its neighbours' sides included.
constexpr int kPointsPerCell = 2;
/// What lies between the points may be denser by this factor: fewer surprises.
constexpr float kReserve = 1.25f;
constexpr size_t kTogether = 32;

double share_of(int i, int count) {
    return count > 0 ? static_cast<double>(i) / count : 0.5;
}

/// Extinctions at the points of one layer of the lattice.
void fill_layer(const Box3d& box, int z, int last, const MajorantGrid::Extinctions& extinctions, float* layer) {
    std::array<Vec3d, kTogether> points;
    const Vec3d size = box.size();
    const int side = last + 1, count = side * side;
    for (int first = 0; first < count; first += static_cast<int>(kTogether)) {
        const int together = std::min(static_cast<int>(kTogether), count - first);
        for (int i = 0; i < together; ++i) {
            const Vec3d share(share_of((first + i) % side, last), share_of((first + i) / side, last),
                              share_of(z, last));
            points[static_cast<size_t>(i)] = box.min + size * share;
        }
        extinctions({points.data(), static_cast<size_t>(together)}, layer + first);
    }
}

}  // namespace

GridLine::GridLine(const Vec3d& from, const Vec3d& towards) : origin(from), direction(towards), per_direction(0.0) {
    for (int axis = 0; axis < 3; ++axis)
        if (direction[axis] != 0.0) per_direction[axis] = 1.0 / direction[axis];
}

MajorantGrid::MajorantGrid(const Box3d& box, int cells)
    : box_(box), cells_(cells), width_(box.size() / static_cast<double>(cells)), per_width_(0.0) {
    for (int axis = 0; axis < 3; ++axis)
        if (width_[axis] > 0.0) per_width_[axis] = 1.0 / width_[axis];
}

MajorantGrid::MajorantGrid(const Box3d& box, int cells, const Extinctions& extinctions, const CancelToken& cancel)
    : MajorantGrid(box, cells) {
    majorants_.assign(static_cast<size_t>(cells) * cells * cells, 0.0f);
    const int last = cells * kPointsPerCell, side = last + 1;
    const size_t layer_size = static_cast<size_t>(side) * side;
    std::vector<float> lattice(layer_size * side);
    tbb::parallel_for(0, side, [&](int z) {
        cancel.throw_if_cancelled();
        fill_layer(box, z, last, extinctions, lattice.data() + layer_size * z);
    });
    for (int z = 0; z < side; ++z)
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                const float value = lattice[layer_size * z + static_cast<size_t>(side) * y + x];
                largest_ = std::max(largest_, value * kReserve);
                const auto first = [](int i) { return std::max((i - 1) / kPointsPerCell, 0); };
                const auto end = [cells](int i) { return std::min(i / kPointsPerCell, cells - 1); };
                for (int k = first(z); k <= end(z); ++k)
                    for (int j = first(y); j <= end(y); ++j)
                        for (int i = first(x); i <= end(x); ++i) {
                            float& majorant = majorants_[(static_cast<size_t>(k) * cells + j) * cells + i];
                            majorant = std::max(majorant, value * kReserve);
                        }
            }
}

MajorantGrid::MajorantGrid(const Box3d& box, int cells, std::vector<float> majorants) : MajorantGrid(box, cells) {
    majorants_ = std::move(majorants);
    for (const float majorant : majorants_) largest_ = std::max(largest_, majorant);
}

MajorantStep MajorantGrid::at(const GridLine& line, double t) const {
    MajorantStep step{largest_, std::numeric_limits<double>::infinity()};
    size_t index = 0;
    for (int axis = 2; axis >= 0; --axis) {
        if (per_width_[axis] == 0.0) continue;
        const double place = line.origin[axis] + line.direction[axis] * t;
        const double cells = (place - box_.min[axis]) * per_width_[axis];
        if (!(cells >= 0.0 && cells < cells_)) return {largest_, std::numeric_limits<double>::infinity()};
        const int cell = static_cast<int>(cells);
        index = index * static_cast<size_t>(cells_) + static_cast<size_t>(cell);
        if (line.per_direction[axis] == 0.0) continue;
        // A little beyond the border, so that rounding never finds the same cell again.
        constexpr double kBeyond = 1e-6;
        const double border =
            box_.min[axis] + width_[axis] * (line.direction[axis] > 0.0 ? cell + 1.0 + kBeyond : cell - kBeyond);
        step.end = std::min(step.end, (border - line.origin[axis]) * line.per_direction[axis]);
    }
    step.majorant = majorants_[index];
    return step;
}

}  // namespace rayleaf
