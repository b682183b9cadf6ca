#include "geometry/volume_grids.h"

#include "base/error.h"
#include "geometry/triangle_mesh.h"

#include <algorithm>

namespace rayleaf {
namespace {

/// Outside of what is held, as a share of the size: rounding then loses nothing of it.
constexpr double kBoxMargin = 1e-4;

Box3d with_margin(const Box3d& box) {
    if (box.isEmpty()) return box;
    const Vec3d margin(max_component(box.size()) * kBoxMargin);
    return {box.min - margin, box.max + margin};
}

/// Around the active voxels of all grids, in terms of the first; `after`: as of VoxelGrid::active_box.
Box3d body_box(const std::vector<NamedGrid>& grids, int after) {
    Box3d box;
    for (const NamedGrid& each : grids) {
        const Box3d active = each.grid->active_box(after);
        if (active.isEmpty()) continue;
        const bool is_first = each.grid == grids.front().grid;
        box.extendBy(is_first ? active
                              : image_of(image_of(active, each.grid->to_object()), grids.front().grid->to_index()));
    }
    return box;
}

std::string names_of(const VolumeGrids& grids) {
    std::string names;
    for (const NamedGrid& each : grids.grids) names += (names.empty() ? "grid '" : ", '") + each.grid->name() + "'";
    return names.empty() ? "grids" : names;
}

/// Copies the voxels of a block; whether any differs from 0.
bool copy_block(const DenseVoxels& dense, const Vec3i& block, std::vector<float>& values, VoxelGrid::Active& active) {
    bool any = false;
    const auto channels = static_cast<size_t>(dense.channels);
    std::fill(values.begin(), values.end(), 0.0f);
    active.reset();
    for (size_t i = 0; i < VoxelGrid::kVoxels; ++i) {
        constexpr int kBits = VoxelGrid::kSideBits, kMask = VoxelGrid::kSide - 1;
        const auto at = static_cast<int>(i);
        const Vec3i voxel = block * VoxelGrid::kSide + Vec3i(at >> (2 * kBits), (at >> kBits) & kMask, at & kMask);
        if (voxel.x >= dense.size.x || voxel.y >= dense.size.y || voxel.z >= dense.size.z) continue;
        const size_t row =
            static_cast<size_t>(voxel.z) * static_cast<size_t>(dense.size.y) + static_cast<size_t>(voxel.y);
        const float* from =
            dense.values.data() + (row * static_cast<size_t>(dense.size.x) + static_cast<size_t>(voxel.x)) * channels;
        float largest = 0.0f;
        for (size_t k = 0; k < channels; ++k) {
            values[i * channels + k] = from[k];
            any |= from[k] != 0.0f;
            largest = std::max(largest, std::abs(from[k]));
        }
        active[i] = largest > 0.0f && largest >= dense.least;
    }
    return any;
}

}  // namespace

size_t VolumeGrids::bytes() const {
    size_t sum = 0;
    for (const NamedGrid& each : grids) sum += each.grid->bytes();
    return sum;
}

Box3d VolumeGrids::bounds() const {
    if (body != VolumeBody::Blocks) return box.isEmpty() ? box : image_of(box, grids.front().grid->to_object());
    Box3d found;
    for (const NamedGrid& each : grids) found.extendBy(each.grid->bounds());
    return found;
}

std::shared_ptr<Shape> volume_box(const std::string& name, VolumeGrids grids) {
    if (grids.body != VolumeBody::Blocks) grids.box = body_box(grids.grids, grids.body == VolumeBody::Box ? 1 : 0);
    const Box3d box = with_margin(grids.bounds());
    if (box.isEmpty()) throw InputError(name, names_of(grids), "empty", "at least one active voxel");
    std::vector<float> vertices;
    for (int i = 0; i < 8; ++i)
        for (int axis = 0; axis < 3; ++axis)
            vertices.push_back(static_cast<float>((i >> axis & 1) ? box.max[axis] : box.min[axis]));
    // Counter-clockwise from the outside; vertex i lies high along x, y, z by its bits 1, 2, 4.
    static constexpr int32_t kTriangles[] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                             2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    TriangleMeshArrays arrays;
    arrays.name = name;
    arrays.vertices = vertices;
    arrays.triangles = kTriangles;
    arrays.grids = std::make_shared<const VolumeGrids>(std::move(grids));
    return std::make_shared<TriangleMesh>(std::move(arrays));
}

std::shared_ptr<VoxelGrid> dense_grid(const std::string& object, const DenseVoxels& voxels) {
    auto grid = std::make_shared<VoxelGrid>(object, voxels.name, voxels.channels, voxels.to_object, voxels.rules);
    std::vector<float> values(size_t{VoxelGrid::kVoxels} * static_cast<size_t>(voxels.channels));
    VoxelGrid::Active active;
    const auto blocks = [](int size) { return (size + VoxelGrid::kSide - 1) >> VoxelGrid::kSideBits; };
    for (int x = 0; x < blocks(voxels.size.x); ++x)
        for (int y = 0; y < blocks(voxels.size.y); ++y)
            for (int z = 0; z < blocks(voxels.size.z); ++z)
                if (copy_block(voxels, {x, y, z}, values, active)) grid->add_block({x, y, z}, values, active);
    return grid;
}

}  // namespace rayleaf
