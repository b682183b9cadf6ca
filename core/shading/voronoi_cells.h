// The points of the cells around one place of a Voronoi texture, several at once in the lanes of vectors: the same bits
// as one by one, on any instruction set.
#pragma once

#include "shading/voronoi.h"

#include <cstddef>
#include <cstdint>

namespace rayleaf {

/// How far points are from a place: by the texture's metric; by Euclid's, squared; or not asked.
enum class CellDistance : uint8_t { None, Metric, Squared };

/// What is asked; then what is found of each cell. Cells are ordered with the first coordinate fastest. Of this many
/// dimensions; the others are not read or set.
struct VoronoiCells {
    static constexpr size_t kMost = 640;  ///< two to either side in four dimensions, and the end of a vector

    int dimensions = 3;
    int reach = 1;         ///< 1 or 2: how many cells to either side of the middle one
    float cell[4];         ///< the cell whose corner is the origin
    float middle[4] = {};  ///< the offset of the middle one from that, whole
    float from[4];         ///< the place that distances are from
    float randomness = 1;
    VoronoiHash hash = VoronoiHash::Jenkins;
    VoronoiMetric metric = VoronoiMetric::Euclidean;  ///< not Minkowski's
    CellDistance distances = CellDistance::None;
    bool chances = false;  ///< whether `chance` is asked

    size_t count = 0;
    alignas(64) float point[4][kMost];   ///< by coordinate
    alignas(64) float chance[3][kMost];  ///< where in its cube it lies at most, 0..1; of three dimensions
    alignas(64) float distance[kMost];

    /// The offset of a cell from the origin's.
    float offset(int axis, size_t i) const;
    void find();
};

}  // namespace rayleaf
