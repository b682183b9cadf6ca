#include "scene/majorant_grid.h"

#include <algorithm>

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

/// Points of a box, evenly, both ends of each side included.
struct Lattice {
    const Box3d& box;
    int last;  ///< along a side
    std::vector<FoundDensity> found;

    Lattice(const Box3d& around, int steps) : box(around), last(steps), found(layer_size() * (size_t(last) + 1)) {}
    size_t layer_size() const { return (static_cast<size_t>(last) + 1) * (static_cast<size_t>(last) + 1); }
    void fill_layer(int z, const MajorantGrid::Lookup& lookup) {
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
    DensityBounds bounds(int x, int y, int z) const {
        constexpr int kSide = kPointsPerCell + 1;
        std::array<FoundDensity, static_cast<size_t>(kSide) * kSide * kSide> own;
        size_t count = 0;
        for (int k = 0; k < kSide; ++k)
            for (int j = 0; j < kSide; ++j) {
                const size_t row = layer_size() * static_cast<size_t>(z * kPointsPerCell + k) +
                                   (static_cast<size_t>(last) + 1) * static_cast<size_t>(y * kPointsPerCell + j);
                for (int i = 0; i < kSide; ++i) own[count++] = found[row + static_cast<size_t>(x * kPointsPerCell + i)];
            }
        return bounds_of(own, own, kReserve);
    }
};

}  // namespace

DensityBounds& DensityBounds::operator+=(const DensityBounds& other) {
    majorant += other.majorant;
    certain += other.certain;
    residual += other.residual;
    mean += other.mean;
    return *this;
}

DensityBounds bounds_of(std::span<const FoundDensity> all, std::span<const FoundDensity> shown, float reserve) {
    Color least(std::numeric_limits<float>::infinity()), most(0.0f), sum(0.0f);
    float lookups = 0.0f;
    bool scatters = true;
    for (const FoundDensity& each : all) {
        scatters = scatters && each.scatters;
        for (int c = 0; c < 3; ++c) {
            least[c] = std::min(least[c], each.extinction[c]);
            most[c] = std::max(most[c], each.extinction[c]);
        }
        lookups = std::max(lookups, each.lookups);
    }
    for (const FoundDensity& each : shown) sum += each.extinction;
    DensityBounds bounds = DensityBounds::none();
    if (scatters) bounds.certain = std::min({least.x, least.y, least.z}) / reserve;
    bounds.majorant = std::max(max_component(most), lookups) * reserve;
    for (int c = 0; c < 3; ++c) {
        bounds.mean[c] = std::clamp(sum[c] / static_cast<float>(shown.size()), least[c], most[c]);
        const float above = most[c] * reserve - bounds.mean[c], below = bounds.mean[c] - least[c] / reserve;
        bounds.residual = std::max({bounds.residual, above, below});
    }
    return bounds;
}

GridLine::GridLine(const Vec3d& from, const Vec3d& towards) : origin(from), direction(towards), per_direction(0.0) {
    for (int axis = 0; axis < 3; ++axis)
        if (direction[axis] != 0.0) per_direction[axis] = 1.0 / direction[axis];
}

MajorantGrid::MajorantGrid(const Box3d& box, int cells)
    : box_(box), cells_(cells), width_(box.size() / static_cast<double>(cells)), per_width_(0.0) {
    for (int axis = 0; axis < 3; ++axis)
        if (width_[axis] > 0.0) per_width_[axis] = 1.0 / width_[axis];
}

MajorantGrid::MajorantGrid(const Box3d& box, int cells, const Lookup& lookup, const CancelToken& cancel)
    : MajorantGrid(box, cells) {
    Lattice lattice(box, cells * kPointsPerCell);
    tbb::parallel_for(0, lattice.last + 1, [&](int z) {
        cancel.throw_if_cancelled();
        lattice.fill_layer(z, lookup);
    });
    bounds_.reserve(static_cast<size_t>(cells) * cells * cells);
    for (int z = 0; z < cells; ++z)
        for (int y = 0; y < cells; ++y)
            for (int x = 0; x < cells; ++x) bounds_.push_back(lattice.bounds(x, y, z));
    note_largest();
}

MajorantGrid::MajorantGrid(const Box3d& box, int cells, std::vector<DensityBounds> bounds) : MajorantGrid(box, cells) {
    bounds_ = std::move(bounds);
    note_largest();
}

void MajorantGrid::note_largest() {
    for (const DensityBounds& each : bounds_) largest_.majorant = std::max(largest_.majorant, each.majorant);
    largest_.residual = largest_.majorant;
}

GridWalk::GridWalk(const MajorantGrid& grid, const GridLine& line) : bounds_(&grid.largest_), beyond_(&grid.largest_) {
    std::ptrdiff_t stride = 1, index = 0;
    for (int axis = 0; axis < 3; ++axis, stride *= grid.cells_) {
        if (grid.per_width_[axis] == 0.0) continue;
        // Rays begin on the border of what is bounded: as good as inside.
        constexpr double kOutside = 1e-6;
        const double place = (line.origin[axis] - grid.box_.min[axis]) * grid.per_width_[axis];
        if (!(place >= -kOutside && place <= grid.cells_ + kOutside)) return;
        const int cell = std::clamp(static_cast<int>(place), 0, grid.cells_ - 1);
        index += stride * cell;
        if (line.direction[axis] == 0.0) continue;
        Axis& walk = axes_[static_cast<size_t>(axis)];
        const bool is_up = line.direction[axis] > 0.0;
        walk.base = (grid.box_.min[axis] - line.origin[axis]) * line.per_direction[axis];
        walk.step = grid.width_[axis] * line.per_direction[axis];
        walk.turn = is_up ? 1 : -1;
        walk.next = is_up ? cell + 1 : cell;
        walk.last = is_up ? grid.cells_ : 0;
        walk.stride = is_up ? stride : -stride;
        walk.find_border();
    }
    bounds_ = &grid.bounds_[static_cast<size_t>(index)];
    find_end();
}

void GridWalk::advance() {
    if (std::isinf(end_)) return;
    Axis& walk = axes_[axes_[0].border <= end_ ? 0 : axes_[1].border <= end_ ? 1 : 2];
    if (walk.next == walk.last) {
        bounds_ = beyond_;
        end_ = std::numeric_limits<double>::infinity();
        return;
    }
    walk.next += walk.turn;
    walk.find_border();
    bounds_ += walk.stride;
    find_end();
}

}  // namespace rayleaf
