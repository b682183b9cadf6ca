// Rays of a packet in lanes, and a block's vertices as they see them: each ray runs along its z axis. Included as
// base/lanes.inl is.

/// A vertex in the space of a ray; z is scaled.
template <class V>
struct Corner {
    V x, y, depth;
};

template <class V>
HWY_INLINE V edge(const Corner<V>& p, const Corner<V>& q) {
    return hn::Sub(hn::Mul(p.x, q.y), hn::Mul(p.y, q.x));
}

template <class V>
HWY_INLINE V size(const Corner<V>& p) {
    return hn::Add(hn::Abs(p.x), hn::Abs(p.y));
}

/// How far the edge functions of a cell may be off: px qy - py qx by the error times all four numbers.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V error(D lanes, const Corner<V>& a, const Corner<V>& b, const Corner<V>& c, const Corner<V>& d) {
    const V sizes = hn::Add(hn::Add(size(a), size(b)), hn::Add(size(c), size(d)));
    return hn::Mul(hn::Add(sizes, hn::Set(lanes, kCornerError)), hn::Set(lanes, kCornerError));
}

/// Vertices as seen from rays' origins, the axis along which the ray is largest last.
template <class V>
struct FromOrigin {
    V x, y, z;
};

/// Of rays that all run mostly along one axis.
template <class D>
class OneAxis {
  public:
    using V = hn::Vec<D>;
    /// `take` makes lanes of an array that has a number for each ray.
    template <class Take>
    HWY_INLINE OneAxis(const RayPacket& rays, int axis, const Take& take)
        : x_((axis + 1) % 3), y_((axis + 2) % 3), z_(axis) {
        origin_ = {take(rays.near_origin[x_]), take(rays.near_origin[y_]), take(rays.near_origin[z_])};
    }
    /// `load` makes lanes of the numbers of a block's vertices, [3][25].
    template <class Load>
    HWY_INLINE FromOrigin<V> seen(int vertex, const Load& load) const {
        return {hn::Sub(load(x_ * kBlockSize + vertex), origin_.x), hn::Sub(load(y_ * kBlockSize + vertex), origin_.y),
                hn::Sub(load(z_ * kBlockSize + vertex), origin_.z)};
    }

  private:
    int x_, y_, z_;
    FromOrigin<V> origin_;
};

/// Of rays that run along any axes: each lane is turned by its own.
template <class D>
class AnyAxes {
  public:
    using V = hn::Vec<D>;
    template <class Take>
    HWY_INLINE AnyAxes(const RayPacket& rays, hn::Mask<D> along_x, hn::Mask<D> along_y, const Take& take)
        : along_x_(along_x), along_y_(along_y) {
        for (int axis = 0; axis < 3; ++axis) origin_[axis] = take(rays.near_origin[axis]);
    }
    template <class Load>
    HWY_INLINE FromOrigin<V> seen(int vertex, const Load& load) const {
        const V x = hn::Sub(load(vertex), origin_[0]);
        const V y = hn::Sub(load(kBlockSize + vertex), origin_[1]);
        const V z = hn::Sub(load(2 * kBlockSize + vertex), origin_[2]);
        return {one_of(y, z, x), one_of(z, x, y), one_of(x, y, z)};
    }

  private:
    hn::Mask<D> along_x_, along_y_;
    V origin_[3];

    HWY_INLINE V one_of(V for_x, V for_y, V for_z) const {
        return hn::IfThenElse(along_x_, for_x, hn::IfThenElse(along_y_, for_y, for_z));
    }
};

/// A ray's way to the z axis; in a lane or in all.
template <class D, class Axes>
struct RayLanes {
    using V = hn::Vec<D>;
    Axes axes;
    V shear_x, shear_y, scale_z, sure_from, sure_to;

    template <class Take>
    HWY_INLINE RayLanes(const RayPacket& rays, const Axes& turned, const Take& take) : axes(turned) {
        shear_x = take(rays.shear_x);
        shear_y = take(rays.shear_y);
        scale_z = take(rays.scale_z);
        sure_from = take(rays.sure_from);
        sure_to = take(rays.sure_to);
    }
    template <class Load>
    HWY_INLINE Corner<V> corner(int vertex, const Load& load) const {
        const FromOrigin<V> from = axes.seen(vertex, load);
        return {hn::Sub(from.x, hn::Mul(shear_x, from.z)), hn::Sub(from.y, hn::Mul(shear_y, from.z)),
                hn::Mul(from.z, scale_z)};
    }
};
