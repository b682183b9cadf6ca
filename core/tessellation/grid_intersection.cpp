#include "tessellation/grid_intersection.h"

#include "tessellation/simd.h"

#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tessellation/grid_intersection.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Half a block: 16 lanes are slower where there are so many, by 7 % for camera rays.
using Lanes = hn::CappedTag<float, 8>;
using Vector = hn::Vec<Lanes>;
using Mask = hn::Mask<Lanes>;
constexpr int kWidth = static_cast<int>(hn::MaxLanes(Lanes()));
/// Cells that one vector holds: kRows rows of kColumns cells of a block.
constexpr int kColumns = kWidth < kBlockCells ? kWidth : kBlockCells;
constexpr int kRows = kWidth / kColumns;

/// One bit for each lane.
HWY_INLINE uint32_t mask_bits(Mask mask) {
    static_assert(std::endian::native == std::endian::little);
    uint64_t bits = 0;  // Highway wants room for 8 bytes.
    hn::StoreMaskBits(Lanes(), mask, reinterpret_cast<uint8_t*>(&bits));
    return static_cast<uint32_t>(bits);
}

/// The blocks that the ray may hit up to t_max, one bit each.
HWY_INLINE uint32_t blocks_on_way(const Grid& grid, const GridRay& ray, float t_max) {
    const Lanes lanes;
    uint32_t bits = 0;
    for (int start = 0; start < kBlocks; start += kWidth) {
        Vector near = hn::Zero(lanes), far = hn::Set(lanes, t_max * kFarFactor);
        for (int axis = 0; axis < 3; ++axis) {
            const Vector origin = hn::Set(lanes, ray.origin[axis]);
            const Vector entry = hn::LoadU(lanes, grid.boxes[axis][ray.near_side[axis]] + start);
            const Vector exit = hn::LoadU(lanes, grid.boxes[axis][1 - ray.near_side[axis]] + start);
            near = hn::Max(near, hn::Mul(hn::Sub(entry, origin), hn::Set(lanes, ray.inverse_near[axis])));
            far = hn::Min(far, hn::Mul(hn::Sub(exit, origin), hn::Set(lanes, ray.inverse_far[axis])));
        }
        bits |= mask_bits(hn::Le(near, far)) << start;
    }
    return bits;
}

/// A corner of each cell in ray space; z is still to be scaled.
struct Corner {
    Vector x, y, z;
};

struct Corners {
    Corner a, b, c, d;  ///< of cell (i, j): (i, j), (i+1, j), (i+1, j+1), (i, j+1)
};

struct RayLanes {
    int axis_x, axis_y, axis_z;
    Vector origin_x, origin_y, origin_z, shear_x, shear_y, scale_z;

    HWY_INLINE explicit RayLanes(const GridRay& ray) : axis_x(ray.axis_x), axis_y(ray.axis_y), axis_z(ray.axis_z) {
        const Lanes lanes;
        origin_x = hn::Set(lanes, ray.origin[ray.axis_x]);
        origin_y = hn::Set(lanes, ray.origin[ray.axis_y]);
        origin_z = hn::Set(lanes, ray.origin[ray.axis_z]);
        shear_x = hn::Set(lanes, ray.shear_x);
        shear_y = hn::Set(lanes, ray.shear_y);
        scale_z = hn::Set(lanes, ray.scale_z);
    }
    HWY_INLINE Corner project(Vector x, Vector y, Vector z) const {
        const Vector dz = hn::Sub(z, origin_z), dx = hn::Sub(x, origin_x), dy = hn::Sub(y, origin_y);
        return {hn::Sub(dx, hn::Mul(shear_x, dz)), hn::Sub(dy, hn::Mul(shear_y, dz)), dz};
    }
};

/// kRows rows of kColumns neighbouring values.
template <class D>
HWY_INLINE hn::Vec<D> load_cells(D lanes, const float* first) {
#if HWY_TARGET != HWY_SCALAR
    if constexpr (hn::MaxLanes(D()) > kBlockCells) {
        const hn::Half<D> half;
        const int rows = static_cast<int>(hn::MaxLanes(half)) / kBlockCells;
        return hn::Combine(lanes, load_cells(half, first + rows * kBlockVertices), load_cells(half, first));
    }
#endif
    return hn::LoadU(lanes, first);
}

/// The cells from (column, row) of the block on.
HWY_INLINE Corners load_corners(const RayLanes& ray, const float (&block)[3][kBlockSize], int column, int row) {
    const Lanes lanes;
    const auto load = [&](int offset) HWY_ATTR {
        const int index = row * kBlockVertices + column + offset;
        return ray.project(load_cells(lanes, block[ray.axis_x] + index), load_cells(lanes, block[ray.axis_y] + index),
                           load_cells(lanes, block[ray.axis_z] + index));
    };
    return {load(0), load(1), load(kBlockVertices + 1), load(kBlockVertices)};
}

HWY_INLINE Vector edge(const Corner& p, const Corner& q) {
    return hn::Sub(hn::Mul(p.x, q.y), hn::Mul(p.y, q.x));
}

/// A triangle of each cell: its edge functions pq, qr, rp and its corners' depths.
struct Triangles {
    Vector pq, qr, rp, pz, qz, rz;

    HWY_INLINE Mask inside() const {
        const Vector zero = hn::Zero(Lanes());
        const Vector smallest = hn::Min(pq, hn::Min(qr, rp)), largest = hn::Max(pq, hn::Max(qr, rp));
        return hn::Or(hn::Ge(smallest, zero), hn::Le(largest, zero));
    }
};

/// Adds the lanes that are hit within the ray's stretch. `first` is the triangle of the first lane.
HWY_INLINE void add_hits(const RayLanes& ray, const Triangles& hit, Mask inside, uint32_t first, Vector t_max,
                         GridCandidates& candidates) {
    const Lanes lanes;
    const Vector area = hn::Add(hn::Add(hit.qr, hit.rp), hit.pq), zero = hn::Zero(lanes);
    const Vector sum = hn::Add(hn::Add(hn::Mul(hit.qr, hit.pz), hn::Mul(hit.rp, hit.qz)), hn::Mul(hit.pq, hit.rz));
    const Vector t = hn::Mul(hn::Div(sum, area), ray.scale_z);
    const Mask within = hn::And(hn::Ge(t, zero), hn::Le(t, t_max));
    uint32_t bits = mask_bits(hn::And(hn::And(inside, hn::Ne(area, zero)), within));
    HWY_ALIGN float distances[kWidth];
    hn::Store(t, lanes, distances);
    for (; bits != 0; bits &= bits - 1) {
        const int lane = __builtin_ctz(bits), row = lane / kColumns, column = lane % kColumns;
        candidates.add({distances[lane], first + static_cast<uint32_t>(2 * (row * kGridCells + column))});
    }
}

void add_candidates(const Grid& grid, const GridRay& ray, float t_max, GridCandidates& candidates) {
    const Lanes lanes;
    const RayLanes ray_lanes(ray);
    const Vector farthest = hn::Set(lanes, t_max);
    for (uint32_t blocks = blocks_on_way(grid, ray, t_max); blocks != 0; blocks &= blocks - 1) {
        const int block = __builtin_ctz(blocks);
        const int first_row = block / kBlockCells * kBlockCells, first_column = block % kBlockCells * kBlockCells;
        for (int row = 0; row < kBlockCells; row += kRows) {
            for (int column = 0; column < kBlockCells; column += kColumns) {
                const auto [a, b, c, d] = load_corners(ray_lanes, grid.vertices[block], column, row);
                const Vector ac = edge(a, c);
                const Triangles lower{edge(a, b), edge(b, c), hn::Neg(ac), a.z, b.z, c.z};
                const Triangles upper{ac, edge(c, d), edge(d, a), a.z, c.z, d.z};
                const Mask in_lower = lower.inside(), in_upper = upper.inside();
                if (hn::AllFalse(lanes, hn::Or(in_lower, in_upper))) continue;
                const auto first = static_cast<uint32_t>(2 * ((first_row + row) * kGridCells + first_column + column));
                if (!hn::AllFalse(lanes, in_lower)) add_hits(ray_lanes, lower, in_lower, first, farthest, candidates);
                if (!hn::AllFalse(lanes, in_upper))
                    add_hits(ray_lanes, upper, in_upper, first + 1, farthest, candidates);
            }
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {

HWY_EXPORT(add_candidates);

AddCandidates add_candidates_function() {
    // The first call through the table chooses; the pointer must be taken after that.
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return &HWY_DYNAMIC_DISPATCH(add_candidates);
}

GridRay::GridRay(const Vec3f& ray_origin, const Vec3f& direction) {
    // Far beyond any box, yet times a box's size still finite.
    constexpr float kHuge = 1e18f;
    for (int axis = 0; axis < 3; ++axis) {
        origin[axis] = ray_origin[axis];
        const float component = direction[axis];
        const float inverse = std::abs(component) > 1.0f / kHuge ? 1.0f / component : std::copysign(kHuge, component);
        near_side[axis] = inverse < 0.0f ? 1 : 0;
        inverse_near[axis] = inverse * kNearFactor;
        inverse_far[axis] = inverse * kFarFactor;
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
