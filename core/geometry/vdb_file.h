// The door to OpenVDB: files of sparse grids.
#pragma once

#include "geometry/voxel_grid.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace rayleaf {

/// Grids of a file by their names; those of `names` that it has not are left out. Grids of other things than numbers
/// and vectors are refused, as are files that cannot be read, by an InputError that names `object`.
std::map<std::string, std::shared_ptr<const VoxelGrid>> read_vdb(const std::string& object, const std::string& path,
                                                                 const std::vector<std::string>& names);

}  // namespace rayleaf
