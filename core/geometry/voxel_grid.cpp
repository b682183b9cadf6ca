#include "geometry/voxel_grid.h"

#include "base/error.h"
#include "base/random.h"

#include <bit>
#include <limits>

namespace rayleaf {
namespace {

/// Voxels this far from 0 have blocks within a BlockTable.
constexpr double kFarthestVoxel = static_cast<double>(BlockTable::kFarthest - 2) * VoxelGrid::kSide;

Vec3i shifted(const Vec3i& voxel, int bits) {
    return {voxel.x >> bits, voxel.y >> bits, voxel.z >> bits};
}

/// Of a voxel in its block, z fastest.
int offset_in_block(const Vec3i& voxel) {
    constexpr int kMask = VoxelGrid::kSide - 1;
    return ((((voxel.x & kMask) << VoxelGrid::kSideBits) | (voxel.y & kMask)) << VoxelGrid::kSideBits) |
           (voxel.z & kMask);
}

void widen(VoxelRange& range, const Vec4f& value) {
    for (int i = 0; i < 4; ++i) {
        range.least[i] = std::min(range.least[i], value[i]);
        range.most[i] = std::max(range.most[i], value[i]);
    }
}

/// `visit` of the numbers of the cells of a lattice of `cells`³ over `box` that another box touches.
template <typename Visit>
void for_cells(const Box3d& box, int cells, const Box3d& touched, const Visit& visit) {
    Vec3i first, last;
    const Vec3d size = box.size();
    for (int axis = 0; axis < 3; ++axis) {
        const double scale = size[axis] > 0.0 ? cells / size[axis] : 0.0, most = cells - 1;
        first[axis] = static_cast<int>(std::clamp((touched.min[axis] - box.min[axis]) * scale, 0.0, most));
        last[axis] = static_cast<int>(std::clamp((touched.max[axis] - box.min[axis]) * scale, 0.0, most));
    }
    const auto side = static_cast<size_t>(cells);
    for (int z = first.z; z <= last.z; ++z)
        for (int y = first.y; y <= last.y; ++y)
            for (int x = first.x; x <= last.x; ++x)
                visit((static_cast<size_t>(z) * side + static_cast<size_t>(y)) * side + static_cast<size_t>(x));
}

}  // namespace

VoxelGrid::VoxelGrid(const std::string& object, std::string name, int channels, const Affine3d& to_object,
                     const GridRules& rules)
    : object_(object),
      name_(std::move(name)),
      channels_(channels),
      to_object_(to_object),
      before_value_(rules.place == ValuePlace::Middle ? 0.5 : 0.0),
      is_stochastic_(rules.mixing == ValueMixing::Stochastic),
      seed_(0),
      least_active_(std::numeric_limits<int>::max()),
      most_active_(std::numeric_limits<int>::lowest()) {
    if (channels != 1 && channels != 3 && channels != 4)
        throw InputError(object, "grid '" + name_ + "'", std::to_string(channels) + " channels", "1, 3 or 4");
    to_index_ = to_object.inverse();
    for (const char letter : name_) seed_ = hash_combine(seed_, static_cast<uint8_t>(letter));
    for (const Affine3d& map : {to_object_, to_index_})
        if (!is_finite(map.x) || !is_finite(map.y) || !is_finite(map.z) || !is_finite(map.translation))
            throw InputError(object, "grid '" + name_ + "'", "without a place in space", "one that has an inverse");
}

Vec4f VoxelGrid::sound(std::span<const float> value) {
    Vec4f result(0.0f, 0.0f, 0.0f, 1.0f);
    for (size_t i = 0; i < value.size(); ++i) {
        const bool good = std::isfinite(value[i]);
        bad_numbers_ += good ? 0 : 1;
        result[static_cast<int>(i)] = good ? value[i] : 0.0f;
    }
    if (channels_ == 1) result.y = result.z = result.x;
    return result;
}

/// A colour is divided by its alpha after it was interpolated, so that what is thick counts more.
Vec4f VoxelGrid::shown(const Vec4f& stored) const {
    constexpr float kLeastAlpha = 1e-6f;  // as Cycles
    if (channels_ != 4) return Vec4f(stored.x, stored.y, stored.z, 1.0f);
    if (!(stored.w > kLeastAlpha)) return stored;
    return Vec4f(stored.x / stored.w, stored.y / stored.w, stored.z / stored.w, stored.w);
}

Vec4f VoxelGrid::stored_at(const float* voxel) const {
    if (channels_ == 1) return Vec4f(voxel[0], voxel[0], voxel[0], 1.0f);
    return Vec4f(voxel[0], voxel[1], voxel[2], channels_ == 4 ? voxel[3] : 1.0f);
}

void VoxelGrid::check_place(const Vec3i& block) const {
    constexpr int kMost = BlockTable::kFarthest - 2;
    for (int axis = 0; axis < 3; ++axis)
        if (std::abs(block[axis]) >= kMost)
            throw InputError(object_, "grid '" + name_ + "'",
                             "a voxel at " + std::to_string(block[axis] * double{kSide}),
                             "whole coordinates below " + std::to_string(kMost * kSide));
}

void VoxelGrid::add_block(const Vec3i& block, std::span<const float> values, const Active& active) {
    check_place(block);
    if (!blocks_.insert(block, static_cast<uint32_t>(ranges_.size()))) return;
    const auto channels = static_cast<size_t>(channels_);
    for (size_t voxel = 0; voxel < kVoxels; ++voxel) {
        const Vec4f value = sound(values.subspan(voxel * channels, channels));
        for (int i = 0; i < channels_; ++i) values_.push_back(value[i]);
        const Vec4f seen = shown(value);
        if (voxel == 0) ranges_.push_back({seen, seen});
        widen(ranges_.back(), seen);
    }
    hold(block, active);
}

/// The block, and those beside it that have a face in common with an active voxel.
void VoxelGrid::hold(const Vec3i& block, const Active& active) {
    if (active.none()) return;
    held_[0].insert(block, 0);
    for (int voxel = 0; voxel < kVoxels; ++voxel) {
        if (!active[static_cast<size_t>(voxel)]) continue;
        const Vec3i in_block(voxel >> (2 * kSideBits), (voxel >> kSideBits) & (kSide - 1), voxel & (kSide - 1));
        extend_active(block * kSide + in_block, block * kSide + in_block);
        for (int axis = 0; axis < 3; ++axis) {
            Vec3i beside = block;
            if (in_block[axis] == 0) --beside[axis];
            if (in_block[axis] == kSide - 1) ++beside[axis];
            if (beside != block) held_[0].insert(beside, 0);
        }
    }
}

/// By the voxels from the first to the last.
void VoxelGrid::extend_active(const Vec3i& first, const Vec3i& last) {
    for (int axis = 0; axis < 3; ++axis) {
        least_active_[axis] = std::min(least_active_[axis], first[axis]);
        most_active_[axis] = std::max(most_active_[axis], last[axis]);
    }
}

void VoxelGrid::add_tile(const Vec3i& first, int side_bits, std::span<const float> value, bool active) {
    for (size_t level = 0; level < kTileBits.size(); ++level) {
        if (kTileBits[level] != side_bits) continue;
        check_place(shifted(first, kSideBits));
        const Vec3i tile = shifted(first, side_bits);
        if (!tile_levels_[level].insert(tile, static_cast<uint32_t>(tiles_.size()))) return;
        tiles_.push_back(sound(value));
        if (active && level == 0) hold(tile, Active().set());
        if (active && level > 0) {
            held_[level].insert(tile, 0);
            extend_active(first, first + Vec3i((1 << side_bits) - 1));
        }
        return;
    }
    throw InputError(object_, "grid '" + name_ + "'", "a tile of 2^" + std::to_string(side_bits), "2^3, 2^7 or 2^12");
}

const Vec4f* VoxelGrid::tile_at(const Vec3i& voxel) const {
    for (size_t level = 0; level < kTileBits.size(); ++level)
        if (const auto tile = tile_levels_[level].find(shifted(voxel, kTileBits[level]))) return &tiles_[*tile];
    return nullptr;
}

Vec4f VoxelGrid::stored(const Vec3i& voxel) const {
    if (const auto block = blocks_.find(shifted(voxel, kSideBits))) {
        const size_t at = size_t{*block} * kVoxels + static_cast<size_t>(offset_in_block(voxel));
        return stored_at(&values_[at * static_cast<size_t>(channels_)]);
    }
    const Vec4f* tile = tile_at(voxel);
    return tile != nullptr ? *tile : background_;
}

/// One of the eight voxels about a place, by their weights.
Vec3i VoxelGrid::chosen(const Vec3d& place) const {
    uint32_t bits = seed_;
    for (int axis = 0; axis < 3; ++axis) {
        const auto number = std::bit_cast<uint64_t>(place[axis]);
        bits = hash_combine(hash_combine(bits, static_cast<uint32_t>(number)), static_cast<uint32_t>(number >> 32));
    }
    Vec3i voxel;
    for (int axis = 0; axis < 3; ++axis) {
        const double low = std::floor(place[axis]);
        bits = hash_combine(bits, static_cast<uint32_t>(axis));
        voxel[axis] = static_cast<int>(low) + (unit_float(bits) < place[axis] - low ? 1 : 0);
    }
    return voxel;
}

Vec4f VoxelGrid::at(const Vec3d& object) const {
    const Vec3d place = to_index_.point(object);
    if (!(max_abs(place) < kFarthestVoxel)) return background_;
    if (is_stochastic_) return shown(stored(chosen(place)));
    const Vec3d low(std::floor(place.x), std::floor(place.y), std::floor(place.z));
    const Vec3i first(static_cast<int>(low.x), static_cast<int>(low.y), static_cast<int>(low.z));
    const Vec3f share(place - low);
    const auto mixed = [&](const auto& corner) {
        Vec4f sum(0.0f, 0.0f, 0.0f, 0.0f);
        for (int i = 0; i < 8; ++i) {
            const Vec3i step(i >> 2, (i >> 1) & 1, i & 1);
            const float weight = (step.x ? share.x : 1.0f - share.x) * (step.y ? share.y : 1.0f - share.y) *
                                 (step.z ? share.z : 1.0f - share.z);
            if (weight > 0.0f) sum += corner(step) * weight;
        }
        return shown(sum);
    };
    constexpr int kLast = kSide - 1;
    const auto block = blocks_.find(shifted(first, kSideBits));
    const bool in_one = (first.x & kLast) < kLast && (first.y & kLast) < kLast && (first.z & kLast) < kLast;
    if (!block || !in_one) return mixed([&](const Vec3i& step) { return stored(first + step); });
    const auto channels = static_cast<size_t>(channels_);
    const float* voxels = &values_[(size_t{*block} * kVoxels + static_cast<size_t>(offset_in_block(first))) * channels];
    return mixed([&](const Vec3i& step) {
        const int further = (((step.x << kSideBits) | step.y) << kSideBits) | step.z;
        return stored_at(voxels + static_cast<size_t>(further) * channels);
    });
}

bool VoxelGrid::holds(const Vec3d& object) const {
    const Vec3d place = to_index_.point(object) + Vec3d(before_value_);
    if (!(max_abs(place) < kFarthestVoxel)) return false;
    const Vec3i voxel(static_cast<int>(std::floor(place.x)), static_cast<int>(std::floor(place.y)),
                      static_cast<int>(std::floor(place.z)));
    if (held_[0].find(shifted(voxel, kSideBits))) return true;
    for (size_t level = 1; level < kTileBits.size(); ++level)
        if (held_[level].size() > 0 && is_beside_tile(voxel, level)) return true;
    return false;
}

/// Or in it: a tile is held with the blocks that touch its faces.
bool VoxelGrid::is_beside_tile(const Vec3i& voxel, size_t level) const {
    const auto is_held = [&](const Vec3i& at) { return held_[level].find(shifted(at, kTileBits[level])).has_value(); };
    if (is_held(voxel)) return true;
    for (int axis = 0; axis < 3; ++axis)
        for (const int way : {-kSide, kSide}) {
            Vec3i beside = voxel;
            beside[axis] += way;
            if (is_held(beside)) return true;
        }
    return false;
}

/// The box in object space of a block or tile, with so many voxels more than from its first to its last.
Box3d VoxelGrid::reach(const Vec3i& place, int side_bits, double before, double after) const {
    const double side = 1 << side_bits;
    const Vec3d first = Vec3d(place.x, place.y, place.z) * side;
    return image_of({first - Vec3d(before), first + Vec3d(side - 1.0 + after)}, to_object_);
}

/// Where `holds` is true because of a block or tile, or a little more.
Box3d VoxelGrid::held_box(const Vec3i& place, size_t level) const {
    const double margin = level == 0 ? 0.0 : kSide;
    return reach(place, kTileBits[level], margin + before_value_, margin + 1.0 - before_value_);
}

Box3d VoxelGrid::active_box(int after) const {
    if (least_active_.x > most_active_.x) return {};
    const Vec3d least(least_active_), most(most_active_);
    return {least - Vec3d(1.0 + before_value_), most + Vec3d(1.0 + after - before_value_)};
}

Box3d VoxelGrid::bounds() const {
    Box3d box;
    for (size_t level = 0; level < kTileBits.size(); ++level)
        held_[level].for_each([&](const Vec3i& place, uint32_t) { box.extendBy(held_box(place, level)); });
    return box;
}

size_t VoxelGrid::bytes() const {
    size_t sum = sizeof(*this) + blocks_.bytes() + values_.capacity() * sizeof(float) +
                 ranges_.capacity() * sizeof(VoxelRange) + tiles_.capacity() * sizeof(Vec4f);
    for (size_t level = 0; level < kTileBits.size(); ++level) sum += tile_levels_[level].bytes() + held_[level].bytes();
    return sum;
}

void VoxelGrid::widen_ranges(const Box3d& box, int cells, std::span<VoxelRange> ranges) const {
    for (VoxelRange& range : ranges) range = {background_, background_};
    const auto widen_by = [&](const Box3d& touched, const VoxelRange& more) {
        for_cells(box, cells, touched, [&](size_t cell) {
            widen(ranges[cell], more.least);
            widen(ranges[cell], more.most);
        });
    };
    blocks_.for_each(
        [&](const Vec3i& place, uint32_t number) { widen_by(reach(place, kSideBits, 1.0, 1.0), ranges_[number]); });
    for (size_t level = 0; level < kTileBits.size(); ++level)
        tile_levels_[level].for_each([&](const Vec3i& place, uint32_t number) {
            const Vec4f value = shown(tiles_[number]);
            widen_by(reach(place, kTileBits[level], 1.0, 1.0), {value, value});
        });
}

void VoxelGrid::mark_held(const Box3d& box, int cells, std::span<uint8_t> held) const {
    for (size_t level = 0; level < kTileBits.size(); ++level)
        held_[level].for_each([&](const Vec3i& place, uint32_t) {
            for_cells(box, cells, held_box(place, level), [&](size_t cell) { held[cell] = 1; });
        });
}

}  // namespace rayleaf
