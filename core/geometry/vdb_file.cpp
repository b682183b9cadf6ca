#include "geometry/vdb_file.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <span>

#include <openvdb/openvdb.h>

namespace rayleaf {
namespace {

static_assert(openvdb::FloatTree::LeafNodeType::LOG2DIM == VoxelGrid::kSideBits);

/// What to name in messages.
struct VdbSource {
    const std::string& object;
    std::string grid;

    [[noreturn]] void refuse(const std::string& got, const std::string& wanted) const {
        throw InputError(object, "grid '" + grid + "'", got, wanted);
    }
};

Vec3d vector_of(const openvdb::Vec3d& v) {
    return {v.x(), v.y(), v.z()};
}

Vec3i voxel_of(const openvdb::Coord& c) {
    return {c.x(), c.y(), c.z()};
}

/// From a voxel's whole coordinates to where its value stands.
Affine3d map_of(const VdbSource& source, const openvdb::math::Transform& transform, ValuePlace value_place) {
    const double before = value_place == ValuePlace::Middle ? 0.5 : 0.0;
    if (!transform.isLinear()) source.refuse("in the frustum of a camera", "one that straight lines bound");
    const auto at = [&](double x, double y, double z) {
        return vector_of(transform.indexToWorld(openvdb::Vec3d(x + before, y + before, z + before)));
    };
    const Vec3d origin = at(0, 0, 0);
    return {at(1, 0, 0) - origin, at(0, 1, 0) - origin, at(0, 0, 1) - origin, origin};
}

template <typename T>
constexpr int kChannelsOf = 1;
template <typename T>
constexpr int kChannelsOf<openvdb::math::Vec3<T>> = 3;

template <typename Value>
void append(std::vector<float>& numbers, const Value& value) {
    if constexpr (kChannelsOf<Value> == 3)
        for (int i = 0; i < 3; ++i) numbers.push_back(static_cast<float>(value[i]));
    else
        numbers.push_back(static_cast<float>(value));
}

template <typename Value>
std::vector<float> numbers_of(const Value& value) {
    std::vector<float> numbers;
    append(numbers, value);
    return numbers;
}

/// Whether the largest of an active voxel's numbers is not below `least`.
bool is_there(std::span<const float> numbers, float least) {
    return std::ranges::any_of(numbers, [&](float number) { return !(std::abs(number) < least); });
}

/// Values of a tree above its leaves: each is one of a whole cube.
template <typename Tree>
void take_tiles(const Tree& tree, VoxelGrid& grid, float least) {
    auto value = tree.cbeginValueAll();
    value.setMaxDepth(Tree::ValueAllCIter::LEAF_DEPTH - 1);
    for (; value; ++value) {
        if (!value.isValueOn() && *value == tree.background()) continue;
        const openvdb::CoordBBox box = value.getBoundingBox();
        const auto level = std::find_if(VoxelGrid::kTileBits.begin(), VoxelGrid::kTileBits.end(),
                                        [&](int bits) { return box.dim().x() == 1 << bits; });
        const std::vector<float> numbers = numbers_of(*value);
        if (level != VoxelGrid::kTileBits.end())
            grid.add_tile(voxel_of(box.min()), *level, numbers, value.isValueOn() && is_there(numbers, least));
    }
}

template <typename Grid>
std::shared_ptr<const VoxelGrid> taken(const VdbSource& source, const openvdb::GridBase::ConstPtr& base,
                                       const VdbReading& reading) {
    const auto typed = openvdb::gridConstPtrCast<Grid>(base);
    if (!typed) return nullptr;
    using Value = typename Grid::ValueType;
    const auto& tree = typed->tree();
    constexpr auto kChannels = size_t{kChannelsOf<Value>};
    auto grid = std::make_shared<VoxelGrid>(source.object, source.grid, kChannelsOf<Value>,
                                            map_of(source, typed->transform(), reading.rules.place), reading.rules);
    grid->set_background(numbers_of(tree.background()));
    take_tiles(tree, *grid, reading.least);
    VoxelGrid::Active active;
    std::vector<float> values;
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
        values.clear();
        for (openvdb::Index i = 0; i < VoxelGrid::kVoxels; ++i) {
            append(values, leaf->getValue(i));
            const std::span<const float> numbers = std::span(values).last(kChannels);
            active[i] = leaf->isValueOn(i) && is_there(numbers, reading.least);
        }
        const Vec3i first = voxel_of(leaf->origin());
        grid->add_block(
            {first.x >> VoxelGrid::kSideBits, first.y >> VoxelGrid::kSideBits, first.z >> VoxelGrid::kSideBits}, values,
            active);
    }
    return grid;
}

template <typename... Grids>
std::shared_ptr<const VoxelGrid> taken_as_any(const VdbSource& source, const openvdb::GridBase::ConstPtr& base,
                                              const VdbReading& reading) {
    std::shared_ptr<const VoxelGrid> grid;
    ((grid = grid ? grid : taken<Grids>(source, base, reading)), ...);
    if (!grid) source.refuse("of the type " + quotable(base->type()), "one of numbers or vectors");
    return grid;
}

std::shared_ptr<const VoxelGrid> taken_grid(const VdbSource& source, const openvdb::GridBase::ConstPtr& base,
                                            const VdbReading& reading) {
    using namespace openvdb;
    return taken_as_any<FloatGrid, Vec3SGrid, DoubleGrid, Int32Grid, Int64Grid, BoolGrid, Vec3DGrid, Vec3IGrid>(
        source, base, reading);
}

}  // namespace

std::map<std::string, std::shared_ptr<const VoxelGrid>> read_vdb(const std::string& object, const std::string& path,
                                                                 const std::vector<std::string>& names,
                                                                 const VdbReading& reading) {
    static std::once_flag initialized;
    std::call_once(initialized, [] { openvdb::initialize(); });
    std::map<std::string, std::shared_ptr<const VoxelGrid>> grids;
    try {
        openvdb::io::File file(path);
        file.open(false);
        for (const std::string& name : names)
            if (file.hasGrid(name)) grids[name] = taken_grid({object, name}, file.readGrid(name), reading);
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {  // OpenVDB's own, and what broken lengths make of memory
        throw InputError(object, "file '" + quotable(path) + "'", quotable(error.what()), "an OpenVDB file");
    }
    return grids;
}

}  // namespace rayleaf
