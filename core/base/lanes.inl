// Helpers of SIMD kernels. Include it once in a kernel's file, inside namespace rayleaf::HWY_NAMESPACE, where `hn` is
// Highway's namespace: it is compiled for each instruction set, so it has no include guard.

/// One bit for each lane.
template <class D>
HWY_INLINE uint32_t mask_bits(D lanes, hn::Mask<D> mask) {
    static_assert(std::endian::native == std::endian::little);
    uint64_t bits = 0;  // Highway writes up to 8 bytes.
    hn::StoreMaskBits(lanes, mask, reinterpret_cast<uint8_t*>(&bits));
    return static_cast<uint32_t>(bits);
}

/// A vector of three in each lane; `V` holds one coordinate of all. Operations are Imath's, in the same order.
template <class V>
struct LaneVec3 {
    V x, y, z;
};
template <class V>
HWY_INLINE LaneVec3<V> operator+(const LaneVec3<V>& a, const LaneVec3<V>& b) {
    return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
template <class V>
HWY_INLINE LaneVec3<V> operator-(const LaneVec3<V>& a, const LaneVec3<V>& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
template <class V>
HWY_INLINE LaneVec3<V> times(const LaneVec3<V>& a, const LaneVec3<V>& b) {
    return {hn::Mul(a.x, b.x), hn::Mul(a.y, b.y), hn::Mul(a.z, b.z)};
}
template <class V>
HWY_INLINE LaneVec3<V> times(const LaneVec3<V>& a, V factor) {
    return {hn::Mul(a.x, factor), hn::Mul(a.y, factor), hn::Mul(a.z, factor)};
}
template <class V>
HWY_INLINE LaneVec3<V> divided(const LaneVec3<V>& a, V by) {
    return {hn::Div(a.x, by), hn::Div(a.y, by), hn::Div(a.z, by)};
}
template <class V>
HWY_INLINE V dot(const LaneVec3<V>& a, const LaneVec3<V>& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
template <class V>
HWY_INLINE LaneVec3<V> cross(const LaneVec3<V>& a, const LaneVec3<V>& b) {
    return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
            hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
template <class V>
HWY_INLINE V max_abs(const LaneVec3<V>& a) {
    return hn::Max(hn::Abs(a.x), hn::Max(hn::Abs(a.y), hn::Abs(a.z)));
}
template <class M, class V>
HWY_INLINE LaneVec3<V> select(M which, const LaneVec3<V>& a, const LaneVec3<V>& b) {
    return {hn::IfThenElse(which, a.x, b.x), hn::IfThenElse(which, a.y, b.y), hn::IfThenElse(which, a.z, b.z)};
}
/// From and to a row of numbers for each coordinate.
template <class D, size_t kCount>
HWY_INLINE LaneVec3<hn::Vec<D>> load(D lanes, const hn::TFromD<D> (*rows)[kCount], size_t first) {
    return {hn::Load(lanes, rows[0] + first), hn::Load(lanes, rows[1] + first), hn::Load(lanes, rows[2] + first)};
}
template <class D, size_t kCount>
HWY_INLINE void store(D lanes, const LaneVec3<hn::Vec<D>>& v, hn::TFromD<D> (*rows)[kCount], size_t first) {
    hn::Store(v.x, lanes, rows[0] + first);
    hn::Store(v.y, lanes, rows[1] + first);
    hn::Store(v.z, lanes, rows[2] + first);
}
