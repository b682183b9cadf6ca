// Directed lines as points of six four-dimensional boxes, one a dominant direction (RI, section 2.1), and the cells
// that halving those boxes makes.
//
// Idea: a line that meets an object's box is given by its dominant axis a, its sense along it, and four numbers: two
// intercepts, where it crosses the box's middle plane across a (with the axes b and c that follow a cyclically), and
// its two slopes d_b / d_a and d_c / d_a, in [-1, 1].
//
// Departure from the paper, which takes the crossings of two opposite faces of the box. But a line may enter or leave
// the box through its other faces, and most do: both planes would have to be widened by the box's depth, which makes
// the root cell of a cube 81 times as large. One plane and slopes make it 16 times as large, and need fewer samples for
// the same error.
//
//
// All lengths are in the local space of a shape (geometry/shape.h), whatever the size and place of the object.
#pragma once

#include "base/vector.h"
#include "rays/ray.h"

#include <array>
#include <cstdint>

namespace rayleaf {

inline constexpr int kLineAxes = 4;        ///< intercepts with b and c, then slopes towards b and c
inline constexpr int kCellCorners = 16;    ///< bit k of a corner's number: the upper side of line axis k
inline constexpr int kLineDirections = 6;  ///< 2 * axis, + 1 where the line runs against it: +x -x +y -y +z -z
inline constexpr int kGreatestCellDepth = 60;
inline constexpr int kGreatestAxisLevel = 31;  ///< how often one axis may be halved: indices are 32 bits

/// A directed line.
struct Line {
    uint8_t direction = 0;                   ///< dominant direction
    std::array<double, kLineAxes> shares{};  ///< of the root cell's sides, each in [0, 1]
};

/// A cell as integers: after `depth` halvings, it is number `index[k]` of 2^level along axis k. Which axes were halved
/// follows from direction and depth (LineSpace::levels).
struct CellKey {
    uint8_t direction = 0;
    uint8_t depth = 0;
    std::array<uint32_t, kLineAxes> index{};
};

class LineSpace {
  public:
    /// The lines through a shape's bounds, local space. The box is widened a little, so that corner rays start outside
    /// the shape and flat boxes have a depth. No line meets an empty box.
    explicit LineSpace(const Box3f& bounds);

    /// The widened box.
    const Box3d& box() const { return box_; }
    /// Half of the box's longest side: the unit in which errors are measured.
    double half_extent() const { return half_extent_; }

    /// The line of a ray whose direction is finite and not zero. The dominant axis is that of the largest component,
    /// the first of x, y, z among equals. Lines that pass the box are moved to the border of the root cell.
    Line line(const Vec3d& origin, const Vec3d& direction) const;

    /// The axis along which cells of a depth are halved: that of the longest side, the first of equal ones. The side of
    /// a slope is measured as its length over the half extent.
    int split_axis(uint8_t direction, int depth) const { return halvings_[direction / 2].split_axis[depth]; }
    /// How often each axis has been halved at a depth.
    const std::array<uint8_t, kLineAxes>& levels(uint8_t direction, int depth) const {
        return halvings_[direction / 2].levels[depth];
    }
    /// The half of a cell that holds a line, or the half with that side.
    CellKey child(const CellKey& cell, bool upper) const;
    bool in_upper_half(const CellKey& cell, const Line& line) const;
    /// Whether a cell's lines are close together compared with the shape: at any depth in the box, they spread over no
    /// more than the bounds along both other axes. Only then do misses at its corners and centre mean that nothing is
    /// hit. A cube's cells are narrow after some 9 halvings, those of needles never.
    bool is_narrow(const CellKey& cell) const;
    /// Where a line lies in a cell, 0 to 1 along each axis.
    std::array<double, kLineAxes> position_in(const CellKey& cell, const Line& line) const;

    /// The ray of a cell's corner or middle, which starts on the box's front face. A pure function of the lattice
    /// point: the fractions index / 2^level are exact, and each coordinate is rounded once. So all cells that share a
    /// corner have the same ray there, bit by bit.
    Ray corner_ray(const CellKey& cell, int corner) const;
    Ray center_ray(const CellKey& cell) const;
    /// The same for a lattice point: `place[k] / 2^31` is the share along axis k.
    Ray lattice_ray(uint8_t direction, const std::array<uint32_t, kLineAxes>& place) const;

    Vec3d center() const { return center_; }
    /// The root cell's half sides; it is centred on 0 in every axis. Intercepts are relative to the box's middle.
    std::array<double, kLineAxes> root_half_sides(int axis) const;

  private:
    /// How cells of one dominant axis are halved, by depth.
    struct Halvings {
        std::array<uint8_t, kGreatestCellDepth + 1> split_axis{};
        std::array<std::array<uint8_t, kLineAxes>, kGreatestCellDepth + 1> levels{};
    };

    Box3d box_;
    Vec3d center_{0, 0, 0}, half_{0, 0, 0};  ///< of the widened box
    Vec3d thickness_{0, 0, 0};               ///< of the bounds
    double half_extent_ = 0;
    std::array<Halvings, 3> halvings_;

    Halvings halvings(int axis) const;
    Ray ray_at(uint8_t direction, const std::array<double, kLineAxes>& shares) const;
};

}  // namespace rayleaf
