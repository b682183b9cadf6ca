// A ray alone on its way through a tree of boxes, the children of a node in the lanes, and what packets share with it.
// Included by trace/box_traversal.cpp, once for each instruction set.

/// Far beyond any box, yet times a box's size still finite.
constexpr float kHuge = 1e18f;
/// A node leaves room for its children: of each level, all but the one that is visited wait.
constexpr int kMostWaiting = (BoxNode::kMostChildren - 1) * (BoxNode::kDeepest + 2) + 1;

/// What waits to be visited, as one number that can be sorted: where it begins, which is not negative, and what it is.
HWY_INLINE uint64_t waiting_at(float near, uint32_t child) {
    return uint64_t{std::bit_cast<uint32_t>(near)} << 32 | child;
}
HWY_INLINE float near_of(uint64_t waiting) {
    return std::bit_cast<float>(static_cast<uint32_t>(waiting >> 32));
}

/// Fetches what lies behind a child that is visited later.
HWY_INLINE void fetch(const BoxNode* nodes, uint32_t child, const BoxVisitor& visitor) {
    const bool is_leaf = (child & BoxNode::kLeaf) != 0;
    const auto* first = static_cast<const char*>(is_leaf ? visitor.items : nodes);
    const uint32_t bytes = is_leaf ? visitor.item_bytes : sizeof(BoxNode);
    first += size_t{child & ~BoxNode::kLeaf} * bytes;
    constexpr uint32_t kLine = 64;
    for (uint32_t offset = 0; offset < bytes; offset += kLine) hwy::Prefetch(first + offset);
}

using Boxes = hn::CappedTag<float, BoxNode::kMostChildren>;
using BoxVector = hn::Vec<Boxes>;
constexpr int kBoxWidth = static_cast<int>(hn::MaxLanes(Boxes()));
using Rays = hn::CappedTag<float, kPacketSize>;
using RayVector = hn::Vec<Rays>;
constexpr int kRayWidth = static_cast<int>(hn::MaxLanes(Rays()));

/// Boxes as the tree's nodes have them.
struct StillBoxes {
    HWY_INLINE BoxVector children(const BoxNode* nodes, uint32_t number, int axis, int side, int first,
                                  BoxVector /*share*/) const {
        return hn::Load(Boxes(), nodes[number].bounds[axis][side] + first);
    }
    HWY_INLINE RayVector child(const BoxNode* nodes, uint32_t number, int axis, int side, uint32_t child,
                               int /*first*/) const {
        return hn::Set(Rays(), nodes[number].bounds[axis][side][child]);
    }
    HWY_INLINE float share(uint32_t /*lane*/) const { return 0.0f; }
};

/// Boxes between those of two times.
struct BoxesInMotion {
    MovingBoxes of;

    HWY_INLINE BoxVector children(const BoxNode* /*nodes*/, uint32_t number, int axis, int side, int first,
                                  BoxVector share) const {
        const BoxBounds* at = of.from + number * of.steps;
        const BoxVector from = hn::Load(Boxes(), at[0].bounds[axis][side] + first);
        return hn::MulAdd(hn::Sub(hn::Load(Boxes(), at[1].bounds[axis][side] + first), from), share, from);
    }
    HWY_INLINE RayVector child(const BoxNode* /*nodes*/, uint32_t number, int axis, int side, uint32_t child,
                               int first) const {
        const BoxBounds* at = of.from + number * of.steps;
        const float from = at[0].bounds[axis][side][child];
        return hn::MulAdd(hn::Set(Rays(), at[1].bounds[axis][side][child] - from), hn::LoadU(Rays(), of.share + first),
                          hn::Set(Rays(), from));
    }
    HWY_INLINE float share(uint32_t lane) const { return of.share[lane]; }
};

/// One over a component of a direction, never infinite.
HWY_INLINE float inverse_of(float component) {
    return std::abs(component) > 1.0f / kHuge ? 1.0f / component : std::copysign(kHuge, component);
}

/// Where a ray alone is: at a node or an item, with others that wait.
struct OnTheWay {
    uint32_t lane, next;
    int count = 0;
    uint64_t waiting[kMostWaiting];  ///< not initialised

    OnTheWay(uint32_t of_lane, uint32_t root) : lane(of_lane), next(root) {}
};

/// One ray: the children of a node in the lanes.
template <typename NodeBoxes>
class OneRay {
  public:
    HWY_INLINE OneRay(const float (&origin)[3], const float (&direction)[3], const NodeBoxes& boxes, uint32_t lane)
        : boxes_(boxes), share_(hn::Set(Boxes(), boxes.share(lane))) {
        for (int axis = 0; axis < 3; ++axis) {
            const float inverse = inverse_of(direction[axis]);
            near_side_[axis] = inverse < 0.0f ? 1 : 0;
            inverse_[axis] = hn::Set(Boxes(), inverse);
            offset_[axis] = hn::Set(Boxes(), origin[axis] * inverse);
        }
    }
    /// Goes on until nothing is left.
    HWY_INLINE void visit(const BoxNode* nodes, uint32_t root, uint32_t lane, float* farthest,
                          const BoxVisitor& visitor) const {
        OnTheWay way(lane, root);
        while (advance<true>(nodes, way, farthest, visitor)) {
        }
    }
    /// Visits what is next and fetches what comes then; false once nothing is left.
    HWY_INLINE bool step(const BoxNode* nodes, OnTheWay& way, float* farthest, const BoxVisitor& visitor) const {
        if (!advance<false>(nodes, way, farthest, visitor)) return false;
        fetch(nodes, way.next, visitor);
        return true;
    }

  private:
    NodeBoxes boxes_;
    BoxVector share_;
    int near_side_[3];
    BoxVector inverse_[3], offset_[3];

    /// Visits what is next, a node or an item; false once nothing is left. kFetch: what waits is fetched.
    template <bool kFetch>
    HWY_INLINE bool advance(const BoxNode* nodes, OnTheWay& way, float* farthest, const BoxVisitor& visitor) const {
        if ((way.next & BoxNode::kLeaf) != 0)
            visitor.visit(visitor.owner, way.next & ~BoxNode::kLeaf, 1u << way.lane, farthest);
        else if (go_down<kFetch>(nodes, farthest[way.lane], way.next, way.waiting, way.count, visitor))
            return true;
        return take_waiting(way, farthest[way.lane]);
    }
    static HWY_INLINE bool take_waiting(OnTheWay& way, float farthest) {
        while (way.count > 0) {
            const uint64_t waiting = way.waiting[--way.count];
            way.next = static_cast<uint32_t>(waiting);
            if (near_of(waiting) <= farthest) return true;
        }
        return false;
    }
    /// Makes the nearest child that is met the next; the others wait, the nearest of them last. False if none is.
    template <bool kFetch>
    HWY_INLINE bool go_down(const BoxNode* nodes, float farthest, uint32_t& next, uint64_t* waiting, int& count,
                            const BoxVisitor& visitor) const {
        const BoxNode& node = nodes[next];
        HWY_ALIGN float nears[BoxNode::kMostChildren];
        uint32_t bits = meet(nodes, next, farthest, nears);
        if (bits == 0) return false;
        const auto take = [&] {
            const auto child = static_cast<size_t>(__builtin_ctz(bits));
            bits &= bits - 1;
            return waiting_at(nears[child], node.child[child]);
        };
        uint64_t nearest = take();
        for (const int bottom = count; bits != 0;) {  // NOLINT(bugprone-infinite-loop): `take` changes the bits
            uint64_t other = take();
            if (other < nearest) std::swap(other, nearest);
            int at = count++;
            for (; at > bottom && waiting[at - 1] < other; --at) waiting[at] = waiting[at - 1];
            waiting[at] = other;
            if (kFetch) fetch(nodes, static_cast<uint32_t>(other), visitor);
        }
        next = static_cast<uint32_t>(nearest);
        return true;
    }
    HWY_INLINE uint32_t meet(const BoxNode* nodes, uint32_t number, float farthest, float* nears) const {
        uint32_t bits = 0;
        for (int first = 0; first < BoxNode::kMostChildren; first += kBoxWidth) {
            BoxVector near = hn::Zero(Boxes()), far = hn::Set(Boxes(), farthest);
            for (int axis = 0; axis < 3; ++axis) {
                const int side = near_side_[axis];
                const BoxVector entry = boxes_.children(nodes, number, axis, side, first, share_);
                const BoxVector exit = boxes_.children(nodes, number, axis, 1 - side, first, share_);
                near = hn::Max(near, hn::MulSub(entry, inverse_[axis], offset_[axis]));
                far = hn::Min(far, hn::MulSub(exit, inverse_[axis], offset_[axis]));
            }
            bits |= mask_bits(Boxes(), hn::Le(near, far)) << first;
            hn::Store(near, Boxes(), nears + first);
        }
        return bits & ((1u << nodes[number].count) - 1u);
    }
};
