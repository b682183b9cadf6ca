// Loads cells of a block of vertices (tessellation/grid.h) into lanes. Included as base/lanes.inl is.

/// Values of neighbours in a block of vertices: as many rows of kBlockCells as fill the vector.
template <class D, typename T>
HWY_INLINE hn::Vec<D> load_cells(D lanes, const T* first) {
#if HWY_TARGET != HWY_SCALAR
    if constexpr (hn::MaxLanes(D()) > kBlockCells) {
        const hn::Half<D> half;
        const int rows = static_cast<int>(hn::MaxLanes(half)) / kBlockCells;
        return hn::Combine(lanes, load_cells(half, first + rows * kBlockVertices), load_cells(half, first));
    }
#endif
    return hn::LoadU(lanes, first);
}
