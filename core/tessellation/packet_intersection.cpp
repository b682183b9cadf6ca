#include "tessellation/packet_intersection.h"

#include "base/simd_choice.h"
#include "tessellation/grid_intersection.h"

#include <array>
#include <bit>
#include <cmath>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tessellation/packet_intersection.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "base/lanes.inl"
#include "tessellation/ray_lanes.inl"
#include "tessellation/vertex_cells.inl"

/// What a facet that is hit for sure leaves of a ray, as LocalRay::float_distance has it.
constexpr float kBeyond = 1.0f + 0x1p-20f, kBeyondBy = 0x1p-12f;

/// A triangle: its edge functions, and its corners' depths.
template <class D>
struct TriangleLanes {
    using V = hn::Vec<D>;
    V pq, qr, rp, a, b, c;

    HWY_INLINE hn::Mask<D> may_be_hit(V off) const {
        return hn::Or(hn::Ge(smallest(), hn::Neg(off)), hn::Le(largest(), off));
    }
    HWY_INLINE hn::Mask<D> is_surely_hit(V off) const {
        return hn::Or(hn::Gt(smallest(), off), hn::Lt(largest(), hn::Neg(off)));
    }
    HWY_INLINE V near() const { return hn::Min(a, hn::Min(b, c)); }
    HWY_INLINE V far() const { return hn::Max(a, hn::Max(b, c)); }

  private:
    HWY_INLINE V smallest() const { return hn::Min(pq, hn::Min(qr, rp)); }
    HWY_INLINE V largest() const { return hn::Max(pq, hn::Max(qr, rp)); }
};

/// The lanes of a mask's bits.
template <class D>
HWY_INLINE hn::Mask<D> mask_of(D lanes, uint32_t bits) {
    static_assert(std::endian::native == std::endian::little);
    const uint64_t room = bits;  // Highway wants 8 bytes.
    return hn::LoadMaskBits(lanes, reinterpret_cast<const uint8_t*>(&room));
}

/// Two triangles in a row of bits become a cell in one, a gap after each four.
HWY_INLINE uint32_t cells_of(uint32_t triangles) {
    uint32_t cells = (triangles | triangles >> 1) & 0x55555555u;
    cells = (cells | cells >> 1) & 0x33333333u;
    cells = (cells | cells >> 2) & 0x0f0f0f0fu;
    return (cells & 0xfu) | (cells >> 3 & 0xfu << 5) | (cells >> 6 & 0xfu << 10) | (cells >> 9 & 0xfu << 15);
}
/// Their corners.
HWY_INLINE uint32_t corners_of(uint32_t cells) {
    const uint32_t low = cells | cells << 1;
    return low | low << kBlockVertices;
}

using Rays = hn::CappedTag<float, kPacketSize>;
using RayVector = hn::Vec<Rays>;
constexpr int kRayWidth = static_cast<int>(hn::MaxLanes(Rays()));

struct NumberedBlock {
    const float* vertices;
    uint32_t number, facets;  ///< BlockVertices::facets

    bool has(uint32_t triangle) const { return (facets >> triangle & 1u) != 0; }
};

/// The lanes of a packet that fill a vector from this one on.
struct LanesFrom {
    size_t first;

    HWY_INLINE RayVector operator()(const float* by_lane) const { return hn::LoadU(Rays(), by_lane + first); }
};

/// Some rays against a block.
template <class Axes>
class BlockTest {
  public:
    /// Bit 0 of the mask is the first lane.
    HWY_INLINE BlockTest(const NumberedBlock& block, const RayPacket& rays, const Axes& axes, LanesFrom lanes,
                         uint32_t mask, float* farthest, OpenFacets& open)
        : block_(block),
          first_lane_(lanes.first),
          out_(farthest + lanes.first),
          start_facets_(rays.start_facet + lanes.first),
          open_(open),
          bits_(mask),
          active_(mask_of(Rays(), mask)),
          rays_(rays, axes, lanes),
          farthest_(lanes(farthest)) {}

    /// Returns the lanes that are hit for sure; bit 0 is the first lane.
    HWY_INLINE uint32_t run() {
        const uint32_t cells = kSpacedCells & cells_of(block_.facets);
        for (uint32_t vertices = corners_of(cells); vertices != 0; vertices &= vertices - 1)
            place(__builtin_ctz(vertices));
        for (uint32_t left = cells; left != 0; left &= left - 1) add_cell(__builtin_ctz(left));
        if (sure_ != 0) hn::StoreU(farthest_, Rays(), out_);
        return sure_;
    }

  private:
    NumberedBlock block_;
    size_t first_lane_;
    float* out_;
    const uint32_t* start_facets_;
    OpenFacets& open_;
    uint32_t bits_;
    hn::Mask<Rays> active_;
    RayLanes<Rays, Axes> rays_;
    RayVector farthest_;
    uint32_t sure_ = 0;
    RayVector x_[kBlockSize], y_[kBlockSize], depth_[kBlockSize];  ///< of each vertex, as the rays see it
    uint64_t beside_[kBlockSize];  ///< of each vertex, the lanes whose ray lies to its left, right, above and below it

    HWY_INLINE void place(int vertex) {
        const Corner<RayVector> corner =
            rays_.corner(vertex, [this](int number) { return hn::Set(Rays(), block_.vertices[number]); });
        const RayVector most = hn::Set(Rays(), kCornerError), least = hn::Set(Rays(), -kCornerError);
        const auto bits = [](hn::Mask<Rays> mask) { return uint64_t{mask_bits(Rays(), mask)}; };
        x_[vertex] = corner.x;
        y_[vertex] = corner.y;
        depth_[vertex] = corner.depth;
        beside_[vertex] = bits(hn::Gt(corner.x, most)) | bits(hn::Lt(corner.x, least)) << kPacketSize |
                          bits(hn::Gt(corner.y, most)) << 2 * kPacketSize |
                          bits(hn::Lt(corner.y, least)) << 3 * kPacketSize;
    }
    HWY_INLINE Corner<RayVector> corner(int vertex) const { return {x_[vertex], y_[vertex], depth_[vertex]}; }
    /// `a` is the cell's first corner.
    HWY_INLINE void add_cell(int a) {
        const int b = a + 1, c = a + kBlockVertices + 1, d = a + kBlockVertices;
        uint64_t passed = (beside_[a] & beside_[b]) & (beside_[c] & beside_[d]);
        passed |= passed >> 2 * kPacketSize;
        if ((bits_ & ~(passed | passed >> kPacketSize)) == 0) return;
        const Corner<RayVector> p = corner(a), q = corner(b), r = corner(c), s = corner(d);
        const RayVector off = error(Rays(), p, q, r, s), pr = edge(p, r);
        const uint32_t triangle = first_triangle(a);
        add({edge(p, q), edge(q, r), hn::Neg(pr), p.depth, q.depth, r.depth}, off, triangle);
        add({pr, edge(r, s), edge(s, p), p.depth, r.depth, s.depth}, off, triangle + 1);
    }
    HWY_INLINE void add(const TriangleLanes<Rays>& triangle, RayVector off, uint32_t number) {
        const auto inside = hn::And(triangle.may_be_hit(off), active_);
        if (hn::AllFalse(Rays(), inside)) return;
        const RayVector near = triangle.near(), far = triangle.far();
        const auto within = hn::And(hn::Ge(far, hn::Zero(Rays())), hn::Le(near, farthest_));
        const auto open = hn::And(inside, within);
        uint32_t bits = mask_bits(Rays(), open);
        if (bits == 0 || !block_.has(number)) return;
        HWY_ALIGN float begins[kRayWidth];
        hn::Store(near, Rays(), begins);
        for (; bits != 0; bits &= bits - 1) {
            const auto lane = static_cast<size_t>(__builtin_ctz(bits));
            if (start_facets_[lane] == facet_number(block_.number, number)) continue;
            open_.add(first_lane_ + lane, {block_.number, number, begins[lane]});
        }
        const auto counts = hn::And(hn::Ge(near, rays_.sure_from), hn::Le(far, rays_.sure_to));
        const auto sure = hn::And(hn::And(open, counts), triangle.is_surely_hit(off));
        const RayVector reach = hn::Add(hn::Mul(far, hn::Set(Rays(), kBeyond)), hn::Set(Rays(), kBeyondBy));
        farthest_ = hn::IfThenElse(sure, hn::Min(farthest_, reach), farthest_);
        sure_ |= mask_bits(Rays(), sure);
    }
};

uint32_t find_together(const NumberedBlock& block, const RayPacket& rays, uint32_t mask, float* farthest,
                       OpenFacets& open) {
    uint32_t sure = 0;
    for (uint32_t first = 0; first < kPacketSize; first += kRayWidth) {
        const auto bits_of = [&](uint32_t lanes) { return lanes >> first & ((1u << kRayWidth) - 1u); };
        const uint32_t bits = bits_of(mask);
        if (bits == 0) continue;
        const LanesFrom lanes{first};
        const auto test = [&](const auto& axes) {
            using Axes = std::decay_t<decltype(axes)>;
            return BlockTest<Axes>(block, rays, axes, lanes, bits, farthest, open).run() << first;
        };
        int axis = 0;
        while (axis < 3 && (bits & ~bits_of(rays.by_axis[static_cast<size_t>(axis)])) != 0) ++axis;
        if (axis < 3)
            sure |= test(OneAxis<Rays>(rays, axis, lanes));
        else
            sure |= test(AnyAxes<Rays>(rays, mask_of(Rays(), bits_of(rays.by_axis[0])),
                                       mask_of(Rays(), bits_of(rays.by_axis[1])), lanes));
    }
    return sure;
}

/// One ray against a block: its vertices in the lanes, then the few cells that the ray may pass, one by one.
class VertexTest {
  public:
    float farthest;
    bool sure = false;  ///< whether a facet was hit for sure

    VertexTest(const NumberedBlock& block, const RayPacket& rays, size_t lane, float t_max, OpenFacets& open)
        : farthest(t_max),
          block_(block),
          lane_(lane),
          open_(open),
          start_facet_(rays.start_facet[lane]),
          sure_from_(rays.sure_from[lane]),
          sure_to_(rays.sure_to[lane]) {}

    /// `load` makes lanes of the block's numbers along one axis, from this one on.
    template <class Load>
    HWY_INLINE void run(const RayPacket& rays, int axis, const Load& load) {
        const size_t lane = lane_;
        const auto in_all = [lane](const float* from) { return hn::Set(Rays(), from[lane]); };
        const RayLanes<Rays, OneAxis<Rays>> ray(rays, OneAxis<Rays>(rays, axis, in_all), in_all);
        const auto corners_from = [&](int vertex) { return ray.corner(vertex, load); };
        VertexCells().run(corners_from, [this](uint32_t triangle, float near, float far, bool surely) {
            add(triangle, near, far, surely);
        });
    }

  private:
    NumberedBlock block_;
    size_t lane_;
    OpenFacets& open_;
    uint32_t start_facet_;
    float sure_from_, sure_to_;

    HWY_INLINE void add(uint32_t triangle, float near, float far, bool surely) {
        if (!(far >= 0.0f && near <= farthest) || !block_.has(triangle)) return;
        if (start_facet_ == facet_number(block_.number, triangle)) return;
        open_.add(lane_, {block_.number, triangle, near});
        if (!surely || near < sure_from_ || far > sure_to_) return;
        sure = true;
        farthest = std::min(farthest, far * kBeyond + kBeyondBy);
    }
};

/// `load` as of VertexTest.
template <class Load>
HWY_INLINE uint32_t find_one_by_one(const NumberedBlock& block, const RayPacket& rays, uint32_t mask, const Load& load,
                                    float* farthest, OpenFacets& open) {
    uint32_t sure = 0;
    for (int axis = 0; axis < 3; ++axis) {
        for (uint32_t bits = mask & rays.by_axis[static_cast<size_t>(axis)]; bits != 0; bits &= bits - 1) {
            const auto lane = static_cast<size_t>(__builtin_ctz(bits));
            VertexTest test(block, rays, lane, farthest[lane], open);
            test.run(rays, axis, load);
            if (!test.sure) continue;
            sure |= 1u << lane;
            farthest[lane] = test.farthest;
        }
    }
    return sure;
}

HWY_INLINE void to_floats(const int32_t* fixed, float* vertices) {
    for (int i = 0; i < 3 * kBlockSize; i += kRayWidth) hn::StoreU(as_floats(fixed + i), Rays(), vertices + i);
}

uint32_t find_in_block(const BlockVertices& vertices, uint32_t block, const RayPacket& rays, uint32_t mask,
                       float* farthest, OpenFacets& open) {
    const bool are_few = std::popcount(mask) <= kFewBlockRays;
    const NumberedBlock numbered{vertices.floats, block, vertices.facets};
    if (are_few && vertices.floats) {
        const auto load = [&](int number) { return hn::LoadU(Rays(), vertices.floats + number); };
        return find_one_by_one(numbered, rays, mask, load, farthest, open);
    }
    if (are_few) {
        const auto load = [&](int number) { return as_floats(vertices.fixed + number); };
        return find_one_by_one(numbered, rays, mask, load, farthest, open);
    }
    if (vertices.floats) return find_together(numbered, rays, mask, farthest, open);
    float room[kVertexRoom];
    to_floats(vertices.fixed, room);
    return find_together({room, block, vertices.facets}, rays, mask, farthest, open);
}

void shear(RayPacket& rays, uint32_t mask) {
    const Rays lanes;
    rays.by_axis = {0, 0, 0};
    for (int first = 0; first < kPacketSize; first += kRayWidth) {
        const uint32_t bits = mask >> first & ((1u << kRayWidth) - 1u);
        if (bits == 0) continue;
        const RayVector x = hn::LoadU(lanes, rays.unit_direction[0] + first);
        const RayVector y = hn::LoadU(lanes, rays.unit_direction[1] + first);
        const RayVector z = hn::LoadU(lanes, rays.unit_direction[2] + first);
        const RayVector size_x = hn::Abs(x), size_y = hn::Abs(y), size_z = hn::Abs(z);
        const auto over_y = hn::Ge(size_x, size_y);
        const auto along_x = hn::And(over_y, hn::Ge(size_x, size_z));
        const auto along_y = hn::AndNot(over_y, hn::Ge(size_y, size_z));
        const RayVector largest = hn::IfThenElse(along_x, x, hn::IfThenElse(along_y, y, z));
        const RayVector next = hn::IfThenElse(along_x, y, hn::IfThenElse(along_y, z, x));
        const RayVector last = hn::IfThenElse(along_x, z, hn::IfThenElse(along_y, x, y));
        const RayVector scale = hn::Div(hn::Set(lanes, 1.0f), largest);
        hn::StoreU(scale, lanes, rays.scale_z + first);
        hn::StoreU(hn::Mul(next, scale), lanes, rays.shear_x + first);
        hn::StoreU(hn::Mul(last, scale), lanes, rays.shear_y + first);
        const uint32_t in_x = mask_bits(lanes, along_x) & bits, in_y = mask_bits(lanes, along_y) & bits;
        rays.by_axis[0] |= in_x << first;
        rays.by_axis[1] |= in_y << first;
        rays.by_axis[2] |= (bits & ~(in_x | in_y)) << first;
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {

HWY_EXPORT(find_in_block);
HWY_EXPORT(shear);

PacketKernels packet_kernels() {
    choose_kernels();
    return {&HWY_DYNAMIC_DISPATCH(shear), &HWY_DYNAMIC_DISPATCH(find_in_block)};
}

}  // namespace rayleaf
#endif
