// A field of numbers or vectors in space, given at the points of a lattice: smoke, fire, what OpenVDB's files hold.
//
// Only what is there takes memory: blocks of 8³ voxels, and tiles, cubes of 8, 128 or 4096 voxels a side that hold one
// value, as OpenVDB has them (Museth 2013, "VDB: High-Resolution Sparse Volumes with Dynamic Topology"). Elsewhere is
// the background.
#pragma once

#include "base/vector.h"
#include "geometry/block_table.h"

#include <array>
#include <bitset>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace rayleaf {

/// What a grid holds somewhere, at least and at most, by channel; as `VoxelGrid::at` shows it.
struct VoxelRange {
    Vec4f least{0, 0, 0, 1}, most{0, 0, 0, 1};
};

/// Where in its voxel, which begins at the whole coordinates of its grid, a value stands. Cycles has it in the middle;
/// since 5.0, as OpenVDB, in the corner of the least coordinates.
enum class ValuePlace : uint8_t { Middle, Corner };

/// What is found between values: the trilinear mean of the eight around; or, as in Cycles since 5.0, one of them, in
/// terms of which that is the mean. Of what a program makes of values it is the mean over samples then (Pharr, Wronski,
/// Salvi, Fajardo 2024, "Filtering After Shading With Stochastic Texture Filtering").
enum class ValueMixing : uint8_t { Trilinear, Stochastic };

struct GridRules {
    ValuePlace place = ValuePlace::Middle;
    ValueMixing mixing = ValueMixing::Trilinear;
};

class VoxelGrid {
  public:
    static constexpr int kSideBits = 3, kSide = 1 << kSideBits, kVoxels = kSide * kSide * kSide;
    /// Sides of tiles, as powers of two.
    static constexpr std::array<int, 3> kTileBits = {3, 7, 12};
    /// Voxels that belong to the body of what is shown, whatever their value.
    using Active = std::bitset<kVoxels>;

    /// `to_object`: of values, from their voxels' whole coordinates. One channel is a number, three are a vector, four
    /// a colour with its alpha, by which it has been multiplied. Throws InputError for other numbers, and for maps
    /// without an inverse.
    VoxelGrid(const std::string& object, std::string name, int channels, const Affine3d& to_object,
              const GridRules& rules = {});

    /// While it is filled. `values`: kVoxels times the channels, z fastest, of the block with the voxels from `block`
    /// times kSide on. Places too far away are refused by an InputError.
    void add_block(const Vec3i& block, std::span<const float> values, const Active& active);
    /// `first`: the tile's lowest voxel, a multiple of its side.
    void add_tile(const Vec3i& first, int side_bits, std::span<const float> value, bool active);
    void set_background(std::span<const float> value) { background_ = shown(sound(value)); }

    const std::string& name() const { return name_; }
    int channels() const { return channels_; }
    /// At a point of object space: a number in x, y, z and 1; a vector and 1; a colour, divided by its alpha again, and
    /// that. Stochastic mixing chooses by the bits of the place.
    Vec4f at(const Vec3d& object) const;
    /// Whether active voxels, or those beside them, are in the block about a point.
    bool holds(const Vec3d& object) const;
    /// Of the blocks for which `holds` is true, in object space.
    Box3d bounds() const;
    /// Of all active voxels, one before them and `after` behind, in terms of `to_index`; empty if none is.
    Box3d active_box(int after) const;
    /// From object space to where values stand: those of the voxel at whole coordinates stand at these.
    const Affine3d& to_index() const { return to_index_; }
    const Affine3d& to_object() const { return to_object_; }
    /// Numbers that were not finite, and are 0 now.
    size_t bad_numbers() const { return bad_numbers_; }
    size_t bytes() const;

    /// Widens the range of each cell of a lattice of `cells`³ over a box in object space, x fastest, by what the grid
    /// holds there; and marks those where `holds` may be true.
    void widen_ranges(const Box3d& box, int cells, std::span<VoxelRange> ranges) const;
    void mark_held(const Box3d& box, int cells, std::span<uint8_t> held) const;

  private:
    /// Numbers of a level of tiles are those of `tiles_`; of blocks, those of `ranges_`.
    std::string object_, name_;
    int channels_;
    Affine3d to_object_, to_index_;
    double before_value_;  ///< how far a voxel begins before its value, voxels
    bool is_stochastic_;
    uint32_t seed_;                     ///< other grids choose otherwise
    Vec3i least_active_, most_active_;  ///< voxels
    Vec4f background_{0, 0, 0, 1};
    BlockTable blocks_;
    std::array<BlockTable, kTileBits.size()> tile_levels_, held_;
    std::vector<float> values_;
    std::vector<VoxelRange> ranges_;
    std::vector<Vec4f> tiles_;  ///< as stored
    size_t bad_numbers_ = 0;

    Vec4f sound(std::span<const float> value);
    Vec4f shown(const Vec4f& stored) const;
    Vec4f stored_at(const float* voxel) const;
    void check_place(const Vec3i& block) const;
    void hold(const Vec3i& block, const Active& active);
    void extend_active(const Vec3i& first, const Vec3i& last);
    bool is_beside_tile(const Vec3i& voxel, size_t level) const;
    Box3d held_box(const Vec3i& place, size_t level) const;
    const Vec4f* tile_at(const Vec3i& voxel) const;
    Vec4f stored(const Vec3i& voxel) const;
    Vec3i chosen(const Vec3d& place) const;
    Box3d reach(const Vec3i& place, int side_bits, double before, double after) const;
};

}  // namespace rayleaf
