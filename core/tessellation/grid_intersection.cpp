#include "tessellation/grid_intersection.h"

#include "base/simd_choice.h"

#include <algorithm>
#include <bit>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tessellation/grid_intersection.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Half a block: 16 lanes are slower for camera rays.
using Lanes = hn::CappedTag<float, 8>;
using Vector = hn::Vec<Lanes>;
constexpr int kWidth = static_cast<int>(hn::MaxLanes(Lanes()));

#include "base/lanes.inl"
#include "tessellation/block_lanes.inl"
#include "tessellation/vertex_cells.inl"

/// The blocks that the ray may hit up to t_max, one bit each; where they begin, unless that is null.
HWY_INLINE uint32_t blocks_on_way(const Grid& grid, const GridRay& ray, float t_max, float padding,
                                  float* begins = nullptr) {
    const Lanes lanes;
    const Vector pad = hn::Set(lanes, padding);
    uint32_t bits = 0;
    for (int start = 0; start < kBlocks; start += kWidth) {
        Vector near = hn::Zero(lanes), far = hn::Set(lanes, t_max * kFarFactor);
        for (int axis = 0; axis < 3; ++axis) {
            const Vector origin = hn::Set(lanes, ray.origin[axis]);
            const int side = ray.near_side[axis];
            Vector entry = hn::LoadU(lanes, grid.boxes[axis][side] + start);
            Vector exit = hn::LoadU(lanes, grid.boxes[axis][1 - side] + start);
            if (padding > 0.0f) {
                entry = side == 0 ? hn::Sub(entry, pad) : hn::Add(entry, pad);
                exit = side == 0 ? hn::Add(exit, pad) : hn::Sub(exit, pad);
            }
            near = hn::Max(near, hn::Mul(hn::Sub(entry, origin), hn::Set(lanes, ray.inverse_near[axis])));
            far = hn::Min(far, hn::Mul(hn::Sub(exit, origin), hn::Set(lanes, ray.inverse_far[axis])));
        }
        bits |= mask_bits(lanes, hn::Le(near, far)) << start;
        if (begins) hn::StoreU(near, lanes, begins + start);
    }
    return bits;
}

uint32_t find_blocks(const Grid& grid, const GridRay& ray, float t_max, float padding) {
    return blocks_on_way(grid, ray, t_max, padding);
}

void find_near_blocks(const Grid& grid, const GridRay& ray, float t_max, NearBlocks& blocks) {
    blocks.bits = blocks_on_way(grid, ray, t_max, 0.0f, blocks.near);
}

/// Vertices in single precision.
struct FloatCells {
    static constexpr bool kIsExact = false;
    using Lanes = hn::CappedTag<float, 8>;
    using Number = float;
    using Stored = float;

    static HWY_INLINE hn::Vec<Lanes> load(const float* first) { return load_cells(Lanes(), first); }
    static HWY_INLINE float origin(const GridRay& ray, int axis) { return ray.origin[axis]; }
    static HWY_INLINE float shear_x(const GridRay& ray) { return ray.shear_x; }
    static HWY_INLINE float shear_y(const GridRay& ray) { return ray.shear_y; }
    static HWY_INLINE float scale_z(const GridRay& ray) { return ray.scale_z; }
};

/// Vertices in fixed-point numbers, tested in double precision.
struct FixedCells {
    static constexpr bool kIsExact = true;
    using Lanes = hn::CappedTag<double, 8>;
    using Number = double;
    using Stored = int32_t;

    static HWY_INLINE hn::Vec<Lanes> load(const int32_t* first) {
        const hn::Rebind<int32_t, Lanes> integers;
        return hn::PromoteTo(Lanes(), load_cells(integers, first));
    }
    static HWY_INLINE double origin(const GridRay& ray, int axis) { return ray.fixed_origin[axis]; }
    static HWY_INLINE double shear_x(const GridRay& ray) { return ray.fixed_shear_x; }
    static HWY_INLINE double shear_y(const GridRay& ray) { return ray.fixed_shear_y; }
    static HWY_INLINE double scale_z(const GridRay& ray) { return ray.fixed_scale_z; }
};

/// The test of a block's cells, a vector of them at a time.
template <class Cells>
struct CellTest {
    using D = typename Cells::Lanes;
    using V = hn::Vec<D>;
    using M = hn::Mask<D>;
    static constexpr int kLaneCount = static_cast<int>(hn::MaxLanes(D()));
    /// Cells that one vector holds: kRows rows of kColumns cells of a block.
    static constexpr int kColumns = kLaneCount < kBlockCells ? kLaneCount : kBlockCells;
    static constexpr int kRows = kLaneCount / kColumns;

    /// A corner of each cell in ray space; z is still to be scaled.
    struct Corner {
        V x, y, z;
    };
    /// A triangle of each cell: its edge functions pq, qr, rp and its corners' depths.
    struct Triangles {
        V pq, qr, rp, pz, qz, rz;

        /// `error` is how far edge functions may be off.
        HWY_INLINE M inside(V error) const {
            const V smallest = hn::Min(pq, hn::Min(qr, rp)), largest = hn::Max(pq, hn::Max(qr, rp));
            return hn::Or(hn::Ge(smallest, hn::Neg(error)), hn::Le(largest, error));
        }
    };

    int axis_x, axis_y, axis_z;
    int cells;  ///< along the grid
    V origin_x, origin_y, origin_z, shear_x, shear_y, scale_z, farthest;

    HWY_INLINE CellTest(const GridRay& ray, int cells_along, float t_max)
        : axis_x(ray.axis_x), axis_y(ray.axis_y), axis_z(ray.axis_z), cells(cells_along) {
        const D lanes;
        origin_x = hn::Set(lanes, Cells::origin(ray, ray.axis_x));
        origin_y = hn::Set(lanes, Cells::origin(ray, ray.axis_y));
        origin_z = hn::Set(lanes, Cells::origin(ray, ray.axis_z));
        shear_x = hn::Set(lanes, Cells::shear_x(ray));
        shear_y = hn::Set(lanes, Cells::shear_y(ray));
        scale_z = hn::Set(lanes, Cells::scale_z(ray));
        farthest = hn::Set(lanes, t_max);
    }
    /// A corner of the cells from `index` of a block [3][25] on.
    HWY_INLINE Corner corner(const typename Cells::Stored* block, int index) const {
        const V dz = hn::Sub(Cells::load(block + axis_z * kBlockSize + index), origin_z);
        const V dx = hn::Sub(Cells::load(block + axis_x * kBlockSize + index), origin_x);
        const V dy = hn::Sub(Cells::load(block + axis_y * kBlockSize + index), origin_y);
        return {hn::Sub(dx, hn::Mul(shear_x, dz)), hn::Sub(dy, hn::Mul(shear_y, dz)), dz};
    }
    static HWY_INLINE V edge(const Corner& p, const Corner& q) { return hn::Sub(hn::Mul(p.x, q.y), hn::Mul(p.y, q.x)); }
    static HWY_INLINE V size(const Corner& p) { return hn::Add(hn::Abs(p.x), hn::Abs(p.y)); }
    /// Error bound of a cell's edge functions: px qy - py qx is off by the error times all four numbers.
    static HWY_INLINE V error(const Corner& a, const Corner& b, const Corner& c, const Corner& d) {
        const D lanes;
        if constexpr (Cells::kIsExact) return hn::Zero(lanes);
        const V sizes = hn::Add(hn::Add(size(a), size(b)), hn::Add(size(c), size(d)));
        return hn::Mul(hn::Add(sizes, hn::Set(lanes, kCornerError)), hn::Set(lanes, kCornerError));
    }
    /// The interval of the ray, from `near` to `far`, in which it meets the triangles, unless it misses them.
    HWY_INLINE void depths(const Triangles& hit, V& near, V& far) const {
        const V p = hn::Mul(hit.pz, scale_z), q = hn::Mul(hit.qz, scale_z), r = hn::Mul(hit.rz, scale_z);
        near = hn::Min(p, hn::Min(q, r));
        far = hn::Max(p, hn::Max(q, r));
    }
    /// Adds the lanes that are hit within the ray's interval. `first` is the triangle of the first lane.
    HWY_INLINE void add_hits(const Triangles& hit, M inside, uint32_t first, GridCandidates& candidates) const {
        const D lanes;
        const V zero = hn::Zero(lanes);
        V near, far;
        if constexpr (Cells::kIsExact) {
            const V area = hn::Add(hn::Add(hit.qr, hit.rp), hit.pq);
            const V sum = hn::Add(hn::Add(hn::Mul(hit.qr, hit.pz), hn::Mul(hit.rp, hit.qz)), hn::Mul(hit.pq, hit.rz));
            near = far = hn::Mul(hn::Div(sum, area), scale_z);
            inside = hn::And(inside, hn::Ne(area, zero));
        } else {
            depths(hit, near, far);
        }
        const M within = hn::And(hn::Ge(far, zero), hn::Le(near, farthest));
        uint32_t bits = mask_bits(lanes, hn::And(inside, within));
        HWY_ALIGN typename Cells::Number distances[kLaneCount];
        hn::Store(near, lanes, distances);
        for (; bits != 0; bits &= bits - 1) {
            const int lane = __builtin_ctz(bits), row = lane / kColumns, column = lane % kColumns;
            candidates.add(
                {static_cast<float>(distances[lane]), first + static_cast<uint32_t>(2 * (row * cells + column))});
        }
    }
    /// The cells from (column, row) of a block on, the first of which is cell `first_cell` of the grid.
    HWY_INLINE void add(const typename Cells::Stored* block, int first_cell, int column, int row,
                        GridCandidates& candidates) const {
        const D lanes;
        const int index = row * kBlockVertices + column;
        // Of cell (i, j): (i, j), (i+1, j), (i+1, j+1), (i, j+1).
        const Corner a = corner(block, index), b = corner(block, index + 1);
        const Corner c = corner(block, index + kBlockVertices + 1);
        const Corner d = corner(block, index + kBlockVertices);
        const V ac = edge(a, c);
        const Triangles lower{edge(a, b), edge(b, c), hn::Neg(ac), a.z, b.z, c.z};
        const Triangles upper{ac, edge(c, d), edge(d, a), a.z, c.z, d.z};
        const V off = error(a, b, c, d);
        const M in_lower = lower.inside(off), in_upper = upper.inside(off);
        if (hn::AllFalse(lanes, hn::Or(in_lower, in_upper))) return;
        const auto first = static_cast<uint32_t>(2 * (first_cell + row * cells + column));
        if (!hn::AllFalse(lanes, in_lower)) add_hits(lower, in_lower, first, candidates);
        if (!hn::AllFalse(lanes, in_upper)) add_hits(upper, in_upper, first + 1, candidates);
    }
};

/// The cells of a block, the first of which is cell `first_cell` of the grid.
template <class Cells>
HWY_INLINE void add_block_cells(const CellTest<Cells>& test, const typename Cells::Stored* block, int first_cell,
                                GridCandidates& candidates) {
    for (int row = 0; row < kBlockCells; row += CellTest<Cells>::kRows)
        for (int column = 0; column < kBlockCells; column += CellTest<Cells>::kColumns)
            test.add(block, first_cell, column, row, candidates);
}

int first_cell(int block, int cells_along) {
    return block / kBlocksAlong * kBlockCells * cells_along + block % kBlocksAlong * kBlockCells;
}

void add_candidates(const SnappedGrid& grid, const GridRay& ray, float t_max, GridCandidates& candidates) {
    const CellTest<FloatCells> test(ray, grid.cells(), t_max);
    uint32_t blocks = 1;
    if (grid.fine()) blocks = blocks_on_way(*grid.fine(), ray, t_max, 0.0f) | grid.blocks_beyond_boxes();
    for (; blocks != 0; blocks &= blocks - 1) {
        const int block = __builtin_ctz(blocks);
        const float* vertices = grid.block_vertices(block);
        HWY_ALIGN float moved[3 * kBlockSize];
        if (grid.moves_block(block)) {
            grid.move_block(block, moved);
            vertices = moved;
        }
        add_block_cells(test, vertices, first_cell(block, grid.cells()), candidates);
    }
}

void add_fixed_block(const Grid& grid, uint32_t block, const GridRay& ray, float t_max, GridCandidates& candidates) {
    const CellTest<FixedCells> test(ray, kGridCells, t_max);
    add_block_cells(test, grid.fixed[block][0], first_cell(static_cast<int>(block), kGridCells), candidates);
}

/// Adds the facets of a block that the ray may hit. `load` makes lanes of its vertices' numbers, [3][25], from one on.
template <class Load>
HWY_INLINE void add_vertex_cells(const GridRay& ray, float t_max, const Load& load, GridCandidates& candidates) {
    struct Corners {
        hn::Vec<VertexLanes> x, y, depth;
    };
    const auto all = [](float number) { return hn::Set(VertexLanes(), number); };
    const auto origin_x = all(ray.origin[ray.axis_x]), origin_y = all(ray.origin[ray.axis_y]);
    const auto origin_z = all(ray.origin[ray.axis_z]), scale_z = all(ray.scale_z);
    const auto shear_x = all(ray.shear_x), shear_y = all(ray.shear_y);
    const auto corners_from = [&](int vertex) {
        const auto z = hn::Sub(load(ray.axis_z * kBlockSize + vertex), origin_z);
        const auto x = hn::Sub(load(ray.axis_x * kBlockSize + vertex), origin_x);
        const auto y = hn::Sub(load(ray.axis_y * kBlockSize + vertex), origin_y);
        return Corners{hn::Sub(x, hn::Mul(shear_x, z)), hn::Sub(y, hn::Mul(shear_y, z)), hn::Mul(z, scale_z)};
    };
    VertexCells().run(corners_from, [&](uint32_t triangle, float near, float far, bool /*surely*/) {
        if (far >= 0.0f && near <= t_max) candidates.add({near, triangle});
    });
}

void add_block_of_floats(const float* vertices, const GridRay& ray, float t_max, GridCandidates& candidates) {
    const auto load = [vertices](int number) { return hn::LoadU(VertexLanes(), vertices + number); };
    add_vertex_cells(ray, t_max, load, candidates);
}

void add_block_of_fixed(const int32_t* vertices, const GridRay& ray, float t_max, GridCandidates& candidates) {
    const auto load = [vertices](int number) { return as_floats(vertices + number); };
    add_vertex_cells(ray, t_max, load, candidates);
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {

HWY_EXPORT(add_candidates);
HWY_EXPORT(find_blocks);
HWY_EXPORT(find_near_blocks);
HWY_EXPORT(add_fixed_block);
HWY_EXPORT(add_block_of_floats);
HWY_EXPORT(add_block_of_fixed);

GridKernels grid_kernels() {
    choose_kernels();
    return {&HWY_DYNAMIC_DISPATCH(add_candidates),      &HWY_DYNAMIC_DISPATCH(find_blocks),
            &HWY_DYNAMIC_DISPATCH(find_near_blocks),    &HWY_DYNAMIC_DISPATCH(add_fixed_block),
            &HWY_DYNAMIC_DISPATCH(add_block_of_floats), &HWY_DYNAMIC_DISPATCH(add_block_of_fixed)};
}

/// The same operations as in a lane of the kernel, since its borders are shared with neighbours.
void add_quad_candidates(const SubpatchDetail& detail, const GridRay& ray, float t_max, GridCandidates& candidates) {
    const Float4 z = load4(detail.corners[ray.axis_z]) - ray.origin[ray.axis_z];
    const Float4 x = (load4(detail.corners[ray.axis_x]) - ray.origin[ray.axis_x]) - ray.shear_x * z;
    const Float4 y = (load4(detail.corners[ray.axis_y]) - ray.origin[ray.axis_y]) - ray.shear_y * z;
    // Around: 0 1, 1 3, 2 0, 3 2. And across, 3 0.
    const Float4 around = x * shuffled<1, 3, 0, 2>(y) - y * shuffled<1, 3, 0, 2>(x);
    const float across = x[3] * y[0] - y[3] * x[0];
    const Float4 sizes = max4(x, -x) + max4(y, -y);
    const float off = (((sizes[0] + sizes[1]) + (sizes[3] + sizes[2])) + kCornerError) * kCornerError;
    const auto test = [&](float ab, float bc, float ca, const Vec3f& depth, uint32_t triangle) {
        const float smallest = std::min({ab, bc, ca}), largest = std::max({ab, bc, ca});
        if (smallest < -off && largest > off) return;
        const Vec3f t = depth * ray.scale_z;
        const float near = std::min({t.x, t.y, t.z}), far = std::max({t.x, t.y, t.z});
        if (far >= 0.0f && near <= t_max) candidates.add({near, triangle});
    };
    test(around[0], around[1], across, {z[0], z[1], z[3]}, 0);
    test(-across, around[3], around[2], {z[0], z[3], z[2]}, 1);
}

void GridRay::set_fixed(const Vec3d& ray_origin, const Vec3d& direction, double speed, double length_of_step) {
    const double steps = 1.0 / length_of_step;  // exact: a power of two
    for (int axis = 0; axis < 3; ++axis) fixed_origin[axis] = ray_origin[axis] * steps;
    step = static_cast<float>(length_of_step);
    fixed_shear_x = direction[axis_x] / direction[axis_z];
    fixed_shear_y = direction[axis_y] / direction[axis_z];
    fixed_scale_z = length_of_step * (speed / direction[axis_z]);
}

GridRay::GridRay(const Vec3f& ray_origin, const Vec3f& direction) {
    // Far beyond any box, yet still finite when multiplied by a box's size.
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
