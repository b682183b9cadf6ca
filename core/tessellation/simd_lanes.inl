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
