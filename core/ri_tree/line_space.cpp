#include "ri_tree/line_space.h"

#include <bit>

namespace rayleaf {
namespace {

/// The box is widened by this on every side, a share of its half extent: far above the rounding of hits, and too little
/// to cost samples.
constexpr double kPaddingShare = 0x1p-10;
/// The half extent of a box that is a single point, local units.
constexpr double kLeastHalfExtent = 0x1p-20;

/// The spread of a narrow cell's lines, as a share of the bounds.
constexpr double kNarrowShare = 1.0;

constexpr int second_axis(int axis) {
    return (axis + 1) % 3;
}
constexpr int third_axis(int axis) {
    return (axis + 2) % 3;
}

int dominant_axis(const Vec3d& direction) {
    int axis = 0;
    for (int other = 1; other < 3; ++other)
        if (std::abs(direction[other]) > std::abs(direction[axis])) axis = other;
    return axis;
}

/// 2^-level, exactly; faster than std::ldexp.
double power_of_half(int level) {
    constexpr int kBias = 1023, kMantissaBits = 52;
    return std::bit_cast<double>(static_cast<uint64_t>(kBias - level) << kMantissaBits);
}

double lattice_share(uint64_t numerator, int level) {
    return static_cast<double>(numerator) * power_of_half(level);
}

}  // namespace

LineSpace::LineSpace(const Box3f& bounds) {
    if (bounds.isEmpty()) return;
    const Vec3d low(bounds.min), high(bounds.max);
    half_extent_ = std::max(0.5 * max_component(high - low), kLeastHalfExtent);
    center_ = (low + high) * 0.5;
    thickness_ = high - low;
    half_ = (high - low) * 0.5 + Vec3d(half_extent_ * kPaddingShare);
    box_ = Box3d(center_ - half_, center_ + half_);
    for (int axis = 0; axis < 3; ++axis) halvings_[axis] = halvings(axis);
}

std::array<double, kLineAxes> LineSpace::root_half_sides(int axis) const {
    // Inside the box a line is at most half its depth away from the middle plane, and no slope is above 1.
    return {half_[second_axis(axis)] + half_[axis], half_[third_axis(axis)] + half_[axis], 1.0, 1.0};
}

LineSpace::Halvings LineSpace::halvings(int axis) const {
    std::array<double, kLineAxes> lengths = root_half_sides(axis);
    for (int slope = 2; slope < kLineAxes; ++slope) lengths[slope] *= half_extent_;
    Halvings result;
    std::array<uint8_t, kLineAxes> levels{};
    for (int depth = 0; depth <= kGreatestCellDepth; ++depth) {
        result.levels[depth] = levels;
        int longest = -1;
        for (int i = 0; i < kLineAxes; ++i)
            if (levels[i] < kGreatestAxisLevel && (longest < 0 || lengths[i] > lengths[longest])) longest = i;
        result.split_axis[depth] = static_cast<uint8_t>(longest);
        lengths[longest] *= 0.5;
        ++levels[longest];
    }
    return result;
}

Line LineSpace::line(const Vec3d& origin, const Vec3d& direction) const {
    const int axis = dominant_axis(direction), b = second_axis(axis), c = third_axis(axis);
    const Vec3d from = origin - center_;
    const double slope_b = direction[b] / direction[axis], slope_c = direction[c] / direction[axis];
    const std::array<double, kLineAxes> coordinates = {from[b] - slope_b * from[axis], from[c] - slope_c * from[axis],
                                                       slope_b, slope_c};
    const std::array<double, kLineAxes> half_sides = root_half_sides(axis);
    Line line;
    line.direction = static_cast<uint8_t>(2 * axis + (direction[axis] < 0.0 ? 1 : 0));
    for (int i = 0; i < kLineAxes; ++i)
        line.shares[i] = std::clamp(0.5 + 0.5 * (coordinates[i] / half_sides[i]), 0.0, 1.0);
    return line;
}

CellKey LineSpace::child(const CellKey& cell, bool upper) const {
    CellKey result = cell;
    uint32_t& index = result.index[split_axis(cell.direction, cell.depth)];
    index = 2 * index + (upper ? 1u : 0u);
    ++result.depth;
    return result;
}

bool LineSpace::in_upper_half(const CellKey& cell, const Line& line) const {
    const int axis = split_axis(cell.direction, cell.depth);
    const int level = levels(cell.direction, cell.depth)[axis];
    return line.shares[axis] >= lattice_share(2 * uint64_t{cell.index[axis]} + 1, level + 1);
}

bool LineSpace::is_narrow(const CellKey& cell) const {
    const int axis = cell.direction / 2;
    const std::array<uint8_t, kLineAxes>& level = levels(cell.direction, cell.depth);
    const std::array<double, kLineAxes> half_sides = root_half_sides(axis);
    const std::array<int, 2> others = {second_axis(axis), third_axis(axis)};
    for (int i = 0; i < 2; ++i) {
        const double intercept = std::ldexp(2.0 * half_sides[i], -level[i]);
        const double slope = std::ldexp(2.0 * half_sides[i + 2], -level[i + 2]);
        if (intercept + slope * 2.0 * half_[axis] > kNarrowShare * thickness_[others[i]]) return false;
    }
    return true;
}

std::array<double, kLineAxes> LineSpace::position_in(const CellKey& cell, const Line& line) const {
    const std::array<uint8_t, kLineAxes>& level = levels(cell.direction, cell.depth);
    std::array<double, kLineAxes> position{};
    for (int i = 0; i < kLineAxes; ++i)
        position[i] = std::clamp(std::ldexp(line.shares[i], level[i]) - cell.index[i], 0.0, 1.0);
    return position;
}

Ray LineSpace::corner_ray(const CellKey& cell, int corner) const {
    const std::array<uint8_t, kLineAxes>& level = levels(cell.direction, cell.depth);
    std::array<double, kLineAxes> shares{};
    for (int i = 0; i < kLineAxes; ++i)
        shares[i] = lattice_share(uint64_t{cell.index[i]} + ((corner >> i) & 1), level[i]);
    return ray_at(cell.direction, shares);
}

Ray LineSpace::center_ray(const CellKey& cell) const {
    const std::array<uint8_t, kLineAxes>& level = levels(cell.direction, cell.depth);
    std::array<double, kLineAxes> shares{};
    for (int i = 0; i < kLineAxes; ++i) shares[i] = lattice_share(2 * uint64_t{cell.index[i]} + 1, level[i] + 1);
    return ray_at(cell.direction, shares);
}

Ray LineSpace::lattice_ray(uint8_t direction, const std::array<uint32_t, kLineAxes>& place) const {
    std::array<double, kLineAxes> shares{};
    for (int i = 0; i < kLineAxes; ++i) shares[i] = lattice_share(place[i], kGreatestAxisLevel);
    return ray_at(direction, shares);
}

Ray LineSpace::ray_at(uint8_t direction, const std::array<double, kLineAxes>& shares) const {
    const int axis = direction / 2, b = second_axis(axis), c = third_axis(axis);
    const double sense = direction % 2 == 0 ? 1.0 : -1.0;
    const std::array<double, kLineAxes> half_sides = root_half_sides(axis);
    // 2 share - 1 is exact: shares are lattice points. So each product is the one rounding of its coordinate.
    std::array<double, kLineAxes> coordinate{};
    for (int i = 0; i < kLineAxes; ++i) coordinate[i] = half_sides[i] * (2.0 * shares[i] - 1.0);
    const double front = -sense * half_[axis];
    Ray ray;
    ray.origin[axis] = center_[axis] + front;
    ray.origin[b] = center_[b] + std::fma(coordinate[2], front, coordinate[0]);
    ray.origin[c] = center_[c] + std::fma(coordinate[3], front, coordinate[1]);
    Vec3d along;
    along[axis] = sense;
    along[b] = sense * coordinate[2];
    along[c] = sense * coordinate[3];
    ray.direction = along / std::sqrt(1.0 + coordinate[2] * coordinate[2] + coordinate[3] * coordinate[3]);
    return ray;
}

}  // namespace rayleaf
