#include "tessellation/step_intersection.h"

#include "base/simd_choice.h"

#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tessellation/step_intersection.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "base/lanes.inl"
#include "tessellation/block_lanes.inl"

template <class D>
HWY_INLINE hn::Vec<D> load_steps(D lanes, const uint16_t* first) {
    const hn::Rebind<int32_t, D> integers;
    const hn::Rebind<uint16_t, D> stored;
    return hn::ConvertTo(lanes, hn::PromoteTo(integers, hn::LoadU(stored, first)));
}

/// As for grids of floats. Bounds are relative to the ray's origin, by one rounding of the corner's distance and one of
/// the sum: 2^-23 together, which the padding covers in addition to a grid's error.
void find_near_steps(const StepGrid& grid, const GridRay& ray, float t_max, NearBlocks& blocks) {
    const hn::CappedTag<float, 8> lanes;
    using Vector = hn::Vec<decltype(lanes)>;
    constexpr int kWidth = static_cast<int>(hn::MaxLanes(lanes));
    constexpr float kPadding = 1.25f * kBlockPadding;
    const Vector step = hn::Set(lanes, ray.step);
    blocks.bits = 0;
    for (int start = 0; start < kBlocks; start += kWidth) {
        Vector near = hn::Zero(lanes), far = hn::Set(lanes, t_max * kFarFactor);
        for (int axis = 0; axis < 3; ++axis) {
            const int side = ray.near_side[axis];
            const float corner = static_cast<float>(grid.corner[axis]) * ray.step - ray.origin[axis];
            const float outwards = side == 0 ? -kPadding : kPadding;
            const Vector entry = hn::Add(hn::Mul(load_steps(lanes, grid.boxes[axis][side] + start), step),
                                         hn::Set(lanes, corner + outwards));
            const Vector exit = hn::Add(hn::Mul(load_steps(lanes, grid.boxes[axis][1 - side] + start), step),
                                        hn::Set(lanes, corner - outwards));
            near = hn::Max(near, hn::Mul(entry, hn::Set(lanes, ray.inverse_near[axis])));
            far = hn::Min(far, hn::Mul(exit, hn::Set(lanes, ray.inverse_far[axis])));
        }
        blocks.bits |= mask_bits(lanes, hn::Le(near, far)) << start;
        hn::StoreU(near, lanes, blocks.near + start);
    }
}

using Lanes = hn::CappedTag<float, 16>;
using Vector = hn::Vec<Lanes>;
constexpr int kLaneCount = static_cast<int>(hn::MaxLanes(Lanes()));
/// A vector holds kRows rows of kColumns cells of a block.
constexpr int kColumns = kLaneCount < kBlockCells ? kLaneCount : kBlockCells;
constexpr int kRows = kLaneCount / kColumns;
/// Room for a block's vertices in whole vectors.
constexpr int kRoom = 32;

/// A block's vertices, projected along the ray.
struct Across {
    HWY_ALIGN float x[kRoom], y[kRoom];
};

struct FlatCorner {
    Vector x, y;
};

HWY_INLINE Vector edge(const FlatCorner& p, const FlatCorner& q) {
    return hn::Sub(hn::Mul(p.x, q.y), hn::Mul(p.y, q.x));
}

/// The triangles of the cells with these corners: lower ones, and upper ones kBlockCells^2 bits above.
HWY_INLINE uint32_t triangles_of(const FlatCorner& a, const FlatCorner& b, const FlatCorner& c, const FlatCorner& d,
                                 float margin) {
    const Lanes lanes;
    const Vector most = hn::Set(lanes, margin), least = hn::Set(lanes, -margin);
    const Vector ac = edge(a, c), ca = hn::Neg(ac);
    const auto may_pass = [&](Vector pq, Vector qr, Vector rp) HWY_ATTR {
        const Vector smallest = hn::Min(pq, hn::Min(qr, rp)), largest = hn::Max(pq, hn::Max(qr, rp));
        return mask_bits(lanes, hn::Or(hn::Ge(smallest, least), hn::Le(largest, most)));
    };
    return may_pass(edge(a, b), edge(b, c), ca) | may_pass(ac, edge(c, d), edge(d, a)) << kBlockCells * kBlockCells;
}

#if HWY_TARGET == HWY_AVX3
/// Of the vertices in two vectors, those that are a corner of the sixteen cells: `first` is the first cell's.
HWY_INLINE Vector corners_of_cells(Vector low, Vector high, int first) {
    const Lanes lanes;
    const hn::Rebind<int32_t, Lanes> integers;
    alignas(64) static constexpr int32_t kCells[16] = {0, 1, 2, 3, 5, 6, 7, 8, 10, 11, 12, 13, 15, 16, 17, 18};
    const auto index = hn::Add(hn::Load(integers, kCells), hn::Set(integers, first));
    const auto within = hn::IndicesFromVec(lanes, hn::And(index, hn::Set(integers, 15)));
    return hn::IfThenElse(hn::RebindMask(lanes, hn::Gt(index, hn::Set(integers, 15))),
                          hn::TableLookupLanes(high, within), hn::TableLookupLanes(low, within));
}
#endif

/// Error bound: a ray that meets a block's box is less than 2^18 steps from the grid's corner where it passes the
/// corner's plane, so `x` and `y` are off by at most 2^-5 steps. Seen along the ray, vertices lie within m of it, twice
/// the block's longest side plus the padding of boxes. An edge function is off by less than m / 6.
uint32_t find_step_triangles(const StepGrid& grid, uint32_t block, const StepRay& ray) {
    const Lanes lanes;
    int longest = 0;
    for (const uint16_t(&sides)[2][kBlocks] : grid.boxes)
        longest = std::max(longest, int{sides[1][block]} - int{sides[0][block]});
    constexpr float kPadding = 128.0f;
    const float margin = 0.25f * (2.0f * static_cast<float>(longest) + kPadding);
    const Vector ray_x = hn::Set(lanes, ray.x), ray_y = hn::Set(lanes, ray.y);
    const Vector shear_x = hn::Set(lanes, ray.shear_x), shear_y = hn::Set(lanes, ray.shear_y);
    const uint16_t* first = grid.vertices[block][0];
    const auto across = [&](int from) HWY_ATTR {
        const Vector z = load_steps(lanes, first + ray.axis_z * kBlockSize + from);
        const Vector x = load_steps(lanes, first + ray.axis_x * kBlockSize + from);
        const Vector y = load_steps(lanes, first + ray.axis_y * kBlockSize + from);
        return FlatCorner{hn::Sub(hn::Sub(x, ray_x), hn::Mul(shear_x, z)),
                          hn::Sub(hn::Sub(y, ray_y), hn::Mul(shear_y, z))};
    };
    // Of cell (i, j): (i, j), (i+1, j), (i+1, j+1), (i, j+1).
#if HWY_TARGET == HWY_AVX3
    const FlatCorner low = across(0), high = across(kLaneCount);
    const auto corner = [&](int at) HWY_ATTR {
        return FlatCorner{corners_of_cells(low.x, high.x, at), corners_of_cells(low.y, high.y, at)};
    };
    return triangles_of(corner(0), corner(1), corner(kBlockVertices + 1), corner(kBlockVertices), margin);
#else
    Across all;
    for (int from = 0; from < kRoom; from += kLaneCount) {
        const FlatCorner vertices = across(from);
        hn::StoreU(vertices.x, lanes, all.x + from);
        hn::StoreU(vertices.y, lanes, all.y + from);
    }
    uint32_t bits = 0;
    for (int row = 0; row < kBlockCells; row += kRows) {
        for (int column = 0; column < kBlockCells; column += kColumns) {
            const auto corner = [&](int at) HWY_ATTR {
                const int index = row * kBlockVertices + column + at;
                return FlatCorner{load_cells(lanes, all.x + index), load_cells(lanes, all.y + index)};
            };
            bits |= triangles_of(corner(0), corner(1), corner(kBlockVertices + 1), corner(kBlockVertices), margin)
                    << (row * kBlockCells + column);
        }
    }
    return bits;
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {

HWY_EXPORT(find_near_steps);
HWY_EXPORT(find_step_triangles);

StepKernels step_kernels() {
    choose_kernels();
    return {&HWY_DYNAMIC_DISPATCH(find_near_steps), &HWY_DYNAMIC_DISPATCH(find_step_triangles)};
}

StepRay::StepRay(const StepGrid& grid, const GridRay& ray)
    : axis_x(ray.axis_x), axis_y(ray.axis_y), axis_z(ray.axis_z) {
    const double depth = grid.corner[axis_z] - ray.fixed_origin[axis_z];
    x = static_cast<float>(ray.fixed_origin[axis_x] + ray.fixed_shear_x * depth - grid.corner[axis_x]);
    y = static_cast<float>(ray.fixed_origin[axis_y] + ray.fixed_shear_y * depth - grid.corner[axis_y]);
    shear_x = static_cast<float>(ray.fixed_shear_x);
    shear_y = static_cast<float>(ray.fixed_shear_y);
}

bool passes(const StepGrid& grid, uint32_t triangle, const GridRay& ray) {
    const BlockTriangle at = block_triangle(triangle);
    double x[3], y[3];
    for (int k = 0; k < 3; ++k) {
        const auto from = [&](int axis) {
            return grid.corner[axis] + grid.vertices[at.block][axis][at.vertices[k]] - ray.fixed_origin[axis];
        };
        const double depth = from(ray.axis_z);
        x[k] = from(ray.axis_x) - ray.fixed_shear_x * depth;
        y[k] = from(ray.axis_y) - ray.fixed_shear_y * depth;
    }
    const double pq = x[0] * y[1] - y[0] * x[1], qr = x[1] * y[2] - y[1] * x[2], rp = x[2] * y[0] - y[2] * x[0];
    const bool inside = (pq >= 0.0 && qr >= 0.0 && rp >= 0.0) || (pq <= 0.0 && qr <= 0.0 && rp <= 0.0);
    return inside && (qr + rp) + pq != 0.0;
}

}  // namespace rayleaf
#endif
