// The corners that a profile is given for its cells, and how a cap fills their outline.
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
    double error = 0;                  ///< how far a chord lies from the profile, profile units; about
    std::vector<Vec2d> corners;        ///< count + 1; the last is the first, bit by bit, of a closed profile
    std::vector<ProfilePlace> begins;  ///< of each cell
    std::vector<double> lengths;       ///< of each cell, in its part's parameter

    ProfilePlace place(double at) const;
    /// Where a place lies, in cells.
    double at(const ProfilePlace& place) const;

    /// Of a cap: the point that sees the whole outline, if there is one, and otherwise triangles of corners.
    std::optional<Vec2d> center;
    std::vector<std::array<uint32_t, 3>> triangles;
    /// Grids that a cap takes.
    uint32_t cap_grids() const;
};

/// Triangles of a cap that is no fan, in one grid.
inline constexpr uint32_t kTrianglesInGrid = 5;

/// The smallest level that holds the parts' corners, up to the finest; no caps yet.
std::vector<ProfileCells> profile_cells(const SweepProfile& profile);
void add_cap(ProfileCells& cells, const SweepProfile& profile);

}  // namespace rayleaf
