// The corners of a profile's cells, and how a cap fills their outline.
#pragma once

#include "splines/sweep_profile.h"
#include "tessellation/grid.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace rayleaf {

/// The finest level has 2^kMostProfileLevels times as many cells as the coarsest.
inline constexpr int kMostProfileLevels = 7;

struct ProfileCells {
    int count = 0;                     ///< of cells, a multiple of 16
    double error = 0;                  ///< approximate distance of chords from the profile, profile units
    std::vector<Vec2d> corners;        ///< count + 1; the last is the first, bit by bit, of a closed profile
    std::vector<ProfilePlace> begins;  ///< of each cell
    std::vector<double> lengths;       ///< of each cell, in its part's parameter

    ProfilePlace place(double at) const;
    /// A place in units of cells.
    double at(const ProfilePlace& place) const;

    /// Of a cap: the point from which the whole outline is visible, if there is one, otherwise triangles of corners.
    std::optional<Vec2d> center;
    std::vector<std::array<uint32_t, 3>> triangles;
    /// Number of grids of a cap.
    uint32_t cap_grids() const;
};

/// Triangles in one grid of a cap that is no fan.
inline constexpr uint32_t kTrianglesInGrid = 5;

/// The levels from the smallest that holds the parts' corners to the finest; without caps.
std::vector<ProfileCells> profile_cells(const SweepProfile& profile);
void add_cap(ProfileCells& cells, const SweepProfile& profile);

}  // namespace rayleaf
