// The door to OpenVDB: files of sparse grids.
#pragma once

#include "geometry/voxel_grid.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace rayleaf {

/// How files are taken.
struct VdbReading {
    GridRules rules = {};
    float least = 0;  ///< active voxels whose largest number is below this count as inactive
};

/// Grids of a file by their names; those of `names` that it has not are left out. Grids of other things than numbers
/// and vectors are refused, as are files that cannot be read, by an InputError that names `object`.
std::map<std::string, std::shared_ptr<const VoxelGrid>> read_vdb(const std::string& object, const std::string& path,
                                                                 const std::vector<std::string>& names,
                                                                 const VdbReading& reading = {});

}  // namespace rayleaf
