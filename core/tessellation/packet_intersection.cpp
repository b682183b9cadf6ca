#include "tessellation/packet_intersection.h"

#include "tessellation/grid.h"
#include "tessellation/grid_intersection.h"
#include "tessellation/simd.h"

#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tessellation/packet_intersection.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, kPacketSize>;
using Vector = hn::Vec<Lanes>;
constexpr int kWidth = static_cast<int>(hn::MaxLanes(Lanes()));

#include "tessellation/simd_lanes.inl"

/// A vertex in the space of each lane's ray.
struct Corner {
    Vector x, y, depth, size;
};

HWY_INLINE Vector edge(const Corner& p, const Corner& q) {
    return hn::Sub(hn::Mul(p.x, q.y), hn::Mul(p.y, q.x));
}

/// Some lanes, whose rays all run mostly along one axis, against a block.
class BlockTest {
  public:
    HWY_INLINE BlockTest(const float* vertices, const RayPacket& rays, int axis, int first_lane, const float* farthest)
        : vertices_(vertices), axis_z_(axis), axis_x_((axis + 1) % 3), axis_y_((axis + 2) % 3) {
        const Lanes lanes;
        const auto load = [&](const float* from) { return hn::LoadU(lanes, from + first_lane); };
        origin_x_ = load(rays.origin[axis_x_]);
        origin_y_ = load(rays.origin[axis_y_]);
        origin_z_ = load(rays.origin[axis_z_]);
        shear_x_ = load(rays.shear_x);
        shear_y_ = load(rays.shear_y);
        scale_z_ = load(rays.scale_z);
        farthest_ = load(farthest);
    }

    /// Adds what the lanes of `mask` may hit; bit 0 is the first lane.
    HWY_INLINE void add(uint32_t mask, uint32_t* hits) const {
        const Lanes lanes;
        Corner low[kBlockVertices], high[kBlockVertices];
        Vector along_low[kBlockCells], along_high[kBlockCells];  // edges from vertex i to i + 1
        load_row(0, low, along_low);
        for (int j = 0; j < kBlockCells; ++j) {
            load_row(j + 1, high, along_high);
            Vector left = edge(high[0], low[0]);  // d a
            for (int i = 0; i < kBlockCells; ++i) {
                const Corner &a = low[i], &b = low[i + 1], &c = high[i + 1], &d = high[i];
                const Vector bc = edge(b, c), ac = edge(a, c);
                const Vector sizes = hn::Add(hn::Add(a.size, b.size), hn::Add(c.size, d.size));
                const Vector off = hn::Mul(hn::Add(sizes, hn::Set(lanes, kCornerError)), hn::Set(lanes, kCornerError));
                const int triangle = 2 * (j * kBlockCells + i);
                add_triangle(along_low[i], bc, hn::Neg(ac), off, {a.depth, b.depth, c.depth}, mask, triangle, hits);
                add_triangle(ac, hn::Neg(along_high[i]), left, off, {a.depth, c.depth, d.depth}, mask, triangle + 1,
                             hits);
                left = hn::Neg(bc);
            }
            for (int i = 0; i < kBlockVertices; ++i) low[i] = high[i];
            for (int i = 0; i < kBlockCells; ++i) along_low[i] = along_high[i];
        }
    }

  private:
    const float* vertices_;
    int axis_z_, axis_x_, axis_y_;
    Vector origin_x_, origin_y_, origin_z_, shear_x_, shear_y_, scale_z_, farthest_;

    struct Depths {
        Vector a, b, c;
    };

    HWY_INLINE Corner corner(int index) const {
        const Lanes lanes;
        const Vector dz = hn::Sub(hn::Set(lanes, vertices_[axis_z_ * kBlockSize + index]), origin_z_);
        const Vector dx = hn::Sub(hn::Set(lanes, vertices_[axis_x_ * kBlockSize + index]), origin_x_);
        const Vector dy = hn::Sub(hn::Set(lanes, vertices_[axis_y_ * kBlockSize + index]), origin_y_);
        const Vector x = hn::Sub(dx, hn::Mul(shear_x_, dz)), y = hn::Sub(dy, hn::Mul(shear_y_, dz));
        return {x, y, hn::Mul(dz, scale_z_), hn::Add(hn::Abs(x), hn::Abs(y))};
    }
    HWY_INLINE void load_row(int j, Corner (&row)[kBlockVertices], Vector (&along)[kBlockCells]) const {
        for (int i = 0; i < kBlockVertices; ++i) row[i] = corner(j * kBlockVertices + i);
        for (int i = 0; i < kBlockCells; ++i) along[i] = edge(row[i], row[i + 1]);
    }
    HWY_INLINE void add_triangle(Vector pq, Vector qr, Vector rp, Vector off, const Depths& depth, uint32_t mask,
                                 int triangle, uint32_t* hits) const {
        const Lanes lanes;
        const Vector smallest = hn::Min(pq, hn::Min(qr, rp)), largest = hn::Max(pq, hn::Max(qr, rp));
        const auto inside = hn::Or(hn::Ge(smallest, hn::Neg(off)), hn::Le(largest, off));
        if (hn::AllFalse(lanes, inside)) return;
        const Vector near = hn::Min(depth.a, hn::Min(depth.b, depth.c));
        const Vector far = hn::Max(depth.a, hn::Max(depth.b, depth.c));
        const auto within = hn::And(hn::Ge(far, hn::Zero(lanes)), hn::Le(near, farthest_));
        for (uint32_t bits = mask_bits(lanes, hn::And(inside, within)) & mask; bits != 0; bits &= bits - 1)
            hits[__builtin_ctz(bits)] |= 1u << triangle;
    }
};

void find_in_block(const float* vertices, const RayPacket& rays, uint32_t mask, const float* farthest,
                   PacketHits& hits) {
    hits.fill(0);
    for (int first = 0; first < kPacketSize; first += kWidth) {
        for (int axis = 0; axis < 3; ++axis) {
            const uint32_t bits = (mask & rays.by_axis[static_cast<size_t>(axis)]) >> first & ((1u << kWidth) - 1u);
            if (bits != 0)
                BlockTest(vertices, rays, axis, first, farthest).add(bits, &hits[static_cast<size_t>(first)]);
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {

HWY_EXPORT(find_in_block);

FindInBlock packet_kernel() {
    // The first call through the table chooses; the pointer must be taken after that.
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return &HWY_DYNAMIC_DISPATCH(find_in_block);
}

void RayPacket::set(int lane, const Vec3f& from, const Vec3f& direction) {
    const Vec3f size(std::abs(direction.x), std::abs(direction.y), std::abs(direction.z));
    const int z = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
    for (int axis = 0; axis < 3; ++axis) {
        origin[axis][lane] = from[axis];
        by_axis[static_cast<size_t>(axis)] &= ~(1u << lane);
    }
    by_axis[static_cast<size_t>(z)] |= 1u << lane;
    scale_z[lane] = 1.0f / direction[z];
    shear_x[lane] = direction[(z + 1) % 3] * scale_z[lane];
    shear_y[lane] = direction[(z + 2) % 3] * scale_z[lane];
}

}  // namespace rayleaf
#endif
