#include "tessellation/grid_intersection.h"

#include "tessellation/simd.h"

#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tessellation/grid_intersection.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, 16>;
using Vector = hn::Vec<Lanes>;
using Mask = hn::Mask<Lanes>;
constexpr int kWidth = static_cast<int>(hn::MaxLanes(Lanes()));
/// Cells that one vector holds: kRows rows of kColumns cells of a block.
constexpr int kColumns = kWidth < kBlockCells ? kWidth : kBlockCells;
constexpr int kRows = kWidth / kColumns;

/// A box test's rounding: (bound - origin) * inverse has three roundings of 2^-24.
constexpr float kShrink = 1.0f - 0x1p-21f, kGrow = 1.0f + 0x1p-21f;

/// The blocks that the ray may hit up to t_max, one bit each.
HWY_INLINE uint32_t blocks_on_way(const Grid& grid, const GridRay& ray, float t_max) {
    const Lanes lanes;
    uint32_t bits = 0;
    for (int start = 0; start < kBlocks; start += kWidth) {
        Vector near = hn::Zero(lanes), far = hn::Set(lanes, t_max);
        for (int axis = 0; axis < 3; ++axis) {
            const int entry = ray.inverse[axis] < 0.0f ? 1 : 0;
            const Vector origin = hn::Set(lanes, ray.origin[axis]), inverse = hn::Set(lanes, ray.inverse[axis]);
            const Vector low = hn::LoadU(lanes, grid.boxes[axis][entry] + start);
            const Vector high = hn::LoadU(lanes, grid.boxes[axis][1 - entry] + start);
            near = hn::Max(near, hn::Mul(hn::Mul(hn::Sub(low, origin), inverse), hn::Set(lanes, kShrink)));
            far = hn::Min(far, hn::Mul(hn::Mul(hn::Sub(high, origin), inverse), hn::Set(lanes, kGrow)));
        }
        uint8_t packed[8] = {};
        hn::StoreMaskBits(lanes, hn::Le(near, far), packed);
        bits |= (packed[0] | static_cast<uint32_t>(packed[1]) << 8) << start;
    }
    return bits;
}

/// kRows rows of kColumns neighbouring values.
template <class D>
HWY_INLINE hn::Vec<D> load_cells(D lanes, const float* first) {
#if HWY_TARGET != HWY_SCALAR
    if constexpr (hn::MaxLanes(D()) > kBlockCells) {
        const hn::Half<D> half;
        const int rows = static_cast<int>(hn::MaxLanes(half)) / kBlockCells;
        return hn::Combine(lanes, load_cells(half, first + rows * kGridVertices), load_cells(half, first));
    }
#endif
    return hn::LoadU(lanes, first);
}

/// A corner of each cell in ray space; z is still to be scaled.
struct Corner {
    Vector x, y, z;
};

struct RayLanes {
    const float *x, *y, *z;  ///< the grid's vertices by the ray's axes
    Vector origin_x, origin_y, origin_z, shear_x, shear_y, scale_z;

    HWY_INLINE RayLanes(const Grid& grid, const GridRay& ray)
        : x(grid.vertices[ray.axis_x]), y(grid.vertices[ray.axis_y]), z(grid.vertices[ray.axis_z]) {
        const Lanes lanes;
        origin_x = hn::Set(lanes, ray.origin[ray.axis_x]);
        origin_y = hn::Set(lanes, ray.origin[ray.axis_y]);
        origin_z = hn::Set(lanes, ray.origin[ray.axis_z]);
        shear_x = hn::Set(lanes, ray.shear_x);
        shear_y = hn::Set(lanes, ray.shear_y);
        scale_z = hn::Set(lanes, ray.scale_z);
    }
    HWY_INLINE Corner corner(int index) const {
        const Lanes lanes;
        const Vector dz = hn::Sub(load_cells(lanes, z + index), origin_z);
        const Vector dx = hn::Sub(load_cells(lanes, x + index), origin_x);
        const Vector dy = hn::Sub(load_cells(lanes, y + index), origin_y);
        return {hn::Sub(dx, hn::Mul(shear_x, dz)), hn::Sub(dy, hn::Mul(shear_y, dz)), dz};
    }
};

HWY_INLINE Vector edge(const Corner& p, const Corner& q) {
    return hn::Sub(hn::Mul(p.x, q.y), hn::Mul(p.y, q.x));
}

/// The lanes' nearest candidates; the triangle's number is exact as a float.
struct Nearest {
    Vector t, triangle;
};

/// Takes the lanes in which the ray passes the triangle (p, q, r). Its edge functions: pq, qr, rp.
HWY_INLINE void take(const RayLanes& ray, Vector pq, Vector qr, Vector rp, Vector pz, Vector qz, Vector rz,
                     Vector triangle, Vector last_t, Vector last_triangle, Nearest& nearest) {
    const Lanes lanes;
    const Vector zero = hn::Zero(lanes);
    const Vector smallest = hn::Min(pq, hn::Min(qr, rp)), largest = hn::Max(pq, hn::Max(qr, rp));
    const Mask inside = hn::Or(hn::Ge(smallest, zero), hn::Le(largest, zero));
    if (hn::AllFalse(lanes, inside)) return;
    const Vector area = hn::Add(hn::Add(qr, rp), pq);
    const Vector sum = hn::Add(hn::Add(hn::Mul(qr, pz), hn::Mul(rp, qz)), hn::Mul(pq, rz));
    const Vector t = hn::Mul(hn::Div(sum, area), ray.scale_z);
    const Mask later = hn::Or(hn::Gt(t, last_t), hn::And(hn::Eq(t, last_t), hn::Gt(triangle, last_triangle)));
    const Mask nearer = hn::Or(hn::Lt(t, nearest.t), hn::And(hn::Eq(t, nearest.t), hn::Lt(triangle, nearest.triangle)));
    const Mask taken = hn::And(hn::And(inside, hn::Ne(area, zero)), hn::And(later, nearer));
    nearest.t = hn::IfThenElse(taken, t, nearest.t);
    nearest.triangle = hn::IfThenElse(taken, triangle, nearest.triangle);
}

/// Twice the number of each lane's cell, counted from the first.
HWY_INLINE Vector lane_offsets() {
    HWY_ALIGN float offsets[kWidth];
    for (int lane = 0; lane < kWidth; ++lane)
        offsets[lane] = static_cast<float>(2 * (lane / kColumns * kGridCells + lane % kColumns));
    return hn::Load(Lanes(), offsets);
}

bool next_candidate(const Grid& grid, const GridRay& ray, float t_max, const GridCandidate& last, GridCandidate& next) {
    uint32_t blocks = blocks_on_way(grid, ray, t_max);
    if (blocks == 0) return false;
    const Lanes lanes;
    const RayLanes ray_lanes(grid, ray);
    const Vector offsets = lane_offsets(), one = hn::Set(lanes, 1.0f);
    // Before the first candidate, facets with t >= 0 count.
    const bool first = last.t < 0.0f;
    const Vector last_t = hn::Set(lanes, first ? 0.0f : last.t);
    const Vector last_triangle = hn::Set(lanes, first ? -1.0f : static_cast<float>(last.triangle));
    const float none = std::numeric_limits<float>::infinity();
    Nearest nearest{hn::Set(lanes, t_max), hn::Set(lanes, none)};
    for (; blocks != 0; blocks &= blocks - 1) {
        const int block = __builtin_ctz(blocks);
        const int first_row = block / kBlockCells * kBlockCells, first_column = block % kBlockCells * kBlockCells;
        for (int row = first_row; row < first_row + kBlockCells; row += kRows) {
            for (int column = first_column; column < first_column + kBlockCells; column += kColumns) {
                const int index = row * kGridVertices + column;
                const Corner a = ray_lanes.corner(index), b = ray_lanes.corner(index + 1);
                const Corner c = ray_lanes.corner(index + kGridVertices + 1),
                             d = ray_lanes.corner(index + kGridVertices);
                const Vector ab = edge(a, b), bc = edge(b, c), ca = edge(c, a), ac = hn::Neg(ca);
                const Vector cd = edge(c, d), da = edge(d, a);
                const Vector lower =
                    hn::Add(hn::Set(lanes, static_cast<float>(2 * (row * kGridCells + column))), offsets);
                take(ray_lanes, ab, bc, ca, a.z, b.z, c.z, lower, last_t, last_triangle, nearest);
                take(ray_lanes, ac, cd, da, a.z, c.z, d.z, hn::Add(lower, one), last_t, last_triangle, nearest);
            }
        }
    }
    const Vector t = hn::MinOfLanes(lanes, nearest.t);
    const Vector triangle =
        hn::MinOfLanes(lanes, hn::IfThenElse(hn::Eq(nearest.t, t), nearest.triangle, hn::Set(lanes, none)));
    const float number = hn::GetLane(triangle);
    if (number == none) return false;
    next.t = hn::GetLane(t);
    next.triangle = static_cast<uint32_t>(number);
    return true;
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {

HWY_EXPORT(next_candidate);

NextCandidate next_candidate_function() {
    // The first call through the table chooses; the pointer must be taken after that.
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return &HWY_DYNAMIC_DISPATCH(next_candidate);
}

GridRay::GridRay(const Vec3f& ray_origin, const Vec3f& direction) {
    // Far beyond any box, yet times a box's size still finite.
    constexpr float kHuge = 1e18f;
    for (int axis = 0; axis < 3; ++axis) {
        origin[axis] = ray_origin[axis];
        const float component = direction[axis];
        inverse[axis] = std::abs(component) > 1.0f / kHuge ? 1.0f / component : std::copysign(kHuge, component);
    }
    const Vec3f size(std::abs(direction.x), std::abs(direction.y), std::abs(direction.z));
    axis_z = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
    axis_x = (axis_z + 1) % 3;
    axis_y = (axis_z + 2) % 3;
    scale_z = 1.0f / direction[axis_z];
    shear_x = direction[axis_x] * scale_z;
    shear_y = direction[axis_y] * scale_z;
}

}  // namespace rayleaf
#endif
