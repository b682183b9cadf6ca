// The grids that fill a volume, by the names that programs give them, and the box that bounds it.
#pragma once

#include "geometry/shape.h"
#include "geometry/voxel_grid.h"

#include <memory>
#include <string>
#include <vector>

namespace rayleaf {

struct NamedGrid {
    AttributeId id = -1;
    std::shared_ptr<const VoxelGrid> grid;
};

/// Whether densities are per unit of the object's space, so that a larger object is as dense as a small one.
enum class DensityUnit : uint8_t { World, Object };

/// What a volume fills: the blocks of 8³ voxels about active ones; as Cycles since 5.0, a box around all of these and
/// one voxel more; or, since 5.2, one that ends where the last of them do.
enum class VolumeBody : uint8_t { Blocks, Box, NarrowBox };

struct VolumeGrids {
    std::vector<NamedGrid> grids;
    DensityUnit unit = DensityUnit::World;
    VolumeBody body = VolumeBody::Blocks;
    /// Of a body that is a box: this, in terms of the first grid's `to_index`. `volume_box` sets it.
    Box3d box;

    /// Null where there is none of that name.
    const VoxelGrid* find(AttributeId id) const {
        for (const NamedGrid& each : grids)
            if (each.id == id) return each.grid.get();
        return nullptr;
    }
    /// Whether there is anything about a point of object space.
    bool holds(const Vec3d& object) const {
        if (body != VolumeBody::Blocks) return box.intersects(grids.front().grid->to_index().point(object));
        for (const NamedGrid& each : grids)
            if (each.grid->holds(object)) return true;
        return false;
    }
    /// Of all that is held, in object space.
    Box3d bounds() const;
    size_t bytes() const;
};

/// An invisible closed box around all that the grids hold. Throws InputError where they hold nothing.
std::shared_ptr<Shape> volume_box(const std::string& name, VolumeGrids grids);

/// A grid whose voxels lie one beside another: `values` x fastest, then y, z; of each voxel its channels together.
struct DenseVoxels {
    std::string name;
    Vec3i size{0, 0, 0};
    int channels = 1;
    std::span<const float> values;
    Affine3d to_object;  ///< from whole coordinates, those of the first voxel being 0
    GridRules rules = {};
    float least = 0;  ///< a voxel is active if its largest channel is not below this, and not 0
};

/// Throws InputError.
std::shared_ptr<VoxelGrid> dense_grid(const std::string& object, const DenseVoxels& voxels);

}  // namespace rayleaf
