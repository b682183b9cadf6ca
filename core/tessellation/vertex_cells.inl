// One ray against a block: its vertices in the lanes, as the ray sees them, then the few cells that it may pass, one by
// one. Included as base/lanes.inl is.

/// The cells of a block, (i, j) at j * 5 + i, the number of its first corner.
constexpr uint32_t kSpacedCells = 0xf | 0xf << 5 | 0xf << 10 | 0xf << 15;

/// Of the two of a cell.
HWY_INLINE uint32_t first_triangle(int cell) {
    return static_cast<uint32_t>(2 * (cell / kBlockVertices * kBlockCells + cell % kBlockVertices));
}

using VertexLanes = hn::CappedTag<float, 16>;
constexpr int kVertexLanes = static_cast<int>(hn::MaxLanes(VertexLanes()));

/// The vertices of the block, and the walk over its cells.
class VertexCells {
  public:
    /// `corner_of` makes lanes of the vertices from this one on: x, y and depth in the space of the ray.
    /// `visit(triangle, near, far, surely)` is told of the triangles that may be hit, between these depths.
    template <class CornerOf, class Visit>
    HWY_INLINE void run(const CornerOf& corner_of, const Visit& visit) {
        const VertexLanes lanes;
        const auto most = hn::Set(lanes, kCornerError), least = hn::Set(lanes, -kCornerError);
        uint32_t right = 0, left = 0, above = 0, below = 0;
        for (int start = 0; start < kBlockSize; start += kVertexLanes) {
            const int first = std::min(start, kBlockSize - kVertexLanes);
            const auto corner = corner_of(first);
            hn::StoreU(corner.x, lanes, x_ + first);
            hn::StoreU(corner.y, lanes, y_ + first);
            hn::StoreU(corner.depth, lanes, depth_ + first);
            right |= mask_bits(lanes, hn::Gt(corner.x, most)) << first;
            left |= mask_bits(lanes, hn::Lt(corner.x, least)) << first;
            above |= mask_bits(lanes, hn::Gt(corner.y, most)) << first;
            below |= mask_bits(lanes, hn::Lt(corner.y, least)) << first;
        }
        const uint32_t passed = all_corners(right) | all_corners(left) | all_corners(above) | all_corners(below);
        for (uint32_t cells = kSpacedCells & ~passed; cells != 0; cells &= cells - 1)
            visit_cell(__builtin_ctz(cells), visit);
    }

  private:
    float x_[kBlockSize], y_[kBlockSize], depth_[kBlockSize];

    /// The cells whose four corners all have their bit.
    static uint32_t all_corners(uint32_t vertices) {
        const uint32_t pairs = vertices & vertices >> 1;
        return pairs & pairs >> kBlockVertices;
    }
    HWY_INLINE float edge_of(int p, int q) const { return x_[p] * y_[q] - y_[p] * x_[q]; }
    HWY_INLINE float size_of(int p) const { return std::abs(x_[p]) + std::abs(y_[p]); }
    template <class Visit>
    HWY_INLINE void visit_cell(int a, const Visit& visit) const {
        const int b = a + 1, c = a + kBlockVertices + 1, d = a + kBlockVertices;
        const float off = (((size_of(a) + size_of(b)) + (size_of(c) + size_of(d))) + kCornerError) * kCornerError;
        const float ac = edge_of(a, c);
        const auto offer = [&](float pq, float qr, float rp, float p, float q, float r, uint32_t triangle) {
            const float smallest = std::min(pq, std::min(qr, rp)), largest = std::max(pq, std::max(qr, rp));
            if (smallest < -off && largest > off) return;
            visit(triangle, std::min(p, std::min(q, r)), std::max(p, std::max(q, r)), smallest > off || largest < -off);
        };
        const uint32_t triangle = first_triangle(a);
        offer(edge_of(a, b), edge_of(b, c), -ac, depth_[a], depth_[b], depth_[c], triangle);
        offer(ac, edge_of(c, d), edge_of(d, a), depth_[a], depth_[c], depth_[d], triangle + 1);
    }
};

/// Lanes of vertices in fixed-point numbers.
HWY_INLINE hn::Vec<VertexLanes> as_floats(const int32_t* fixed) {
    const hn::Rebind<int32_t, VertexLanes> integers;
    return hn::Mul(hn::ConvertTo(VertexLanes(), hn::LoadU(integers, fixed)),
                   hn::Set(VertexLanes(), static_cast<float>(kFixedStep)));
}
