// Vectors and the Bernstein basis over the lanes of SurfaceLanes, with the operations of BernsteinBasis in the same
// order. Include it after base/lanes.inl, as that is.

using Doubles = hn::CappedTag<double, SurfaceLanes::kMost>;
using Floats = hn::Rebind<float, Doubles>;
using Double = hn::Vec<Doubles>;
using Float = hn::Vec<Floats>;
using Mask = hn::Mask<Doubles>;
constexpr size_t kWidth = hn::MaxLanes(Doubles());
static_assert(SurfaceLanes::kMost % kWidth == 0);

HWY_INLINE Double all(double x) {
    return hn::Set(Doubles(), x);
}

using Vec3 = LaneVec3<Double>;
using FloatVec3 = LaneVec3<Float>;

HWY_INLINE Mask is_finite(Double x) {
    return hn::Le(hn::Abs(x), all(DBL_MAX));
}
HWY_INLINE Mask is_finite(const Vec3& a) {
    return hn::And(is_finite(a.x), hn::And(is_finite(a.y), is_finite(a.z)));
}

HWY_INLINE FloatVec3 to_floats(const Vec3& a) {
    const Floats tag;
    return {hn::DemoteTo(tag, a.x), hn::DemoteTo(tag, a.y), hn::DemoteTo(tag, a.z)};
}
HWY_INLINE Vec3 to_doubles(const FloatVec3& a) {
    const Doubles tag;
    return {hn::PromoteTo(tag, a.x), hn::PromoteTo(tag, a.y), hn::PromoteTo(tag, a.z)};
}

using Offsets = hn::Vec<hn::RebindToSigned<Doubles>>;

/// Numbers that lie at the same place of something that each lane has one of.
template <typename T>
class OfEach {
  public:
    HWY_INLINE explicit OfEach(const T* const* objects) : first_(objects[0]) {
        alignas(64) int64_t offsets[kWidth];
        for (size_t i = 0; i < kWidth; ++i) {
            offsets[i] =
                static_cast<int64_t>(reinterpret_cast<intptr_t>(objects[i]) - reinterpret_cast<intptr_t>(first_));
            is_one_ &= offsets[i] == 0;
        }
        offsets_ = hn::Load(hn::RebindToSigned<Doubles>(), offsets);
    }
    const T& first() const { return *first_; }
    /// `number` is the first lane's.
    HWY_INLINE Double number(const double& number) const {
        return is_one_ ? all(number) : hn::GatherOffset(Doubles(), &number, offsets_);
    }
    /// The same where a lane's number lies so many bytes further from its object than the first lane's. Lanes that have
    /// one object have no such bytes.
    HWY_INLINE Double number(const double& number, Offsets further) const {
        return is_one_ ? all(number) : hn::GatherOffset(Doubles(), &number, hn::Add(offsets_, further));
    }
    HWY_INLINE Vec3 vector(const Vec3d& v) const { return {number(v.x), number(v.y), number(v.z)}; }

  private:
    const T* first_;
    bool is_one_ = true;
    Offsets offsets_;
};

/// normalized_or() where there is a direction; clears the lanes of `sound` that have none.
HWY_INLINE Vec3 normalized(const Vec3& v, Mask& sound) {
    const Double largest = max_abs(v);
    const Vec3 scaled = divided(v, largest);
    const Double length = hn::Sqrt(dot(scaled, scaled));
    // The scaled vector's length is 1 at least, unless something was not a number.
    sound = hn::And(sound, hn::And(hn::Gt(largest, all(0.0)), hn::And(is_finite(largest), hn::Ge(length, all(1.0)))));
    return divided(scaled, length);
}
HWY_INLINE FloatVec3 normalized(const FloatVec3& v, Mask& sound) {
    const Float largest = max_abs(v);
    const FloatVec3 scaled = divided(v, largest);
    const Float length = hn::Sqrt(dot(scaled, scaled));
    const Double of = hn::PromoteTo(Doubles(), largest);
    const Mask has_length = hn::Ge(hn::PromoteTo(Doubles(), length), all(1.0));
    sound = hn::And(sound, hn::And(hn::Gt(of, all(0.0)), hn::And(is_finite(of), has_length)));
    return divided(scaled, length);
}

/// Imath's length(), of what is not tiny; clears the lanes of `sound` where it is.
HWY_INLINE Double length_of(const Vec3& v, Mask& sound) {
    const Double squared = dot(v, v);
    sound = hn::And(sound, hn::And(hn::Ge(squared, all(2.0 * DBL_MIN)), is_finite(squared)));
    return hn::Sqrt(squared);
}

/// A degree that is known when this is compiled.
template <int kDegree>
struct FixedDegree {
    static constexpr int kMost = kDegree;
    HWY_INLINE explicit FixedDegree(int /*degree*/) {}
    HWY_INLINE constexpr operator int() const { return kDegree; }  // NOLINT(google-explicit-constructor): it is one
};
/// Any other.
struct AnyDegree {
    static constexpr int kMost = SurfaceLanes::kMostDegree;
    int degree;
    HWY_INLINE explicit AnyDegree(int of) : degree(of) {}
    HWY_INLINE operator int() const { return degree; }  // NOLINT(google-explicit-constructor): it is one
};

/// BernsteinBasis's.
template <typename Degree>
struct Basis {
    Degree degree;
    Double value_of[Degree::kMost + 1], first_of[Degree::kMost], second_of[Degree::kMost];

    HWY_INLINE Basis(Degree of, Double t) : degree(of) {
        value_of[0] = all(1.0);
        const Double s = hn::Sub(all(1.0), t);
        for (int k = 0; k < degree; ++k) {
            if (k == degree - 2)
                for (int i = 0; i <= k; ++i) second_of[i] = value_of[i];
            if (k == degree - 1)
                for (int i = 0; i <= k; ++i) first_of[i] = value_of[i];
            value_of[k + 1] = hn::Mul(value_of[k], t);
            for (int i = k; i > 0; --i) value_of[i] = hn::Add(hn::Mul(value_of[i], s), hn::Mul(value_of[i - 1], t));
            value_of[0] = hn::Mul(value_of[0], s);
        }
    }
    HWY_INLINE Double value(const Double* points) const {
        Double sum = hn::Mul(points[0], value_of[0]);
        for (int i = 1; i <= degree; ++i) sum = hn::Add(sum, hn::Mul(points[i], value_of[i]));
        return sum;
    }
    HWY_INLINE Double first(const Double* points) const {
        Double sum = hn::Mul(points[0], all(0.0));
        for (int i = 0; i < degree; ++i) sum = hn::Add(sum, hn::Mul(hn::Sub(points[i + 1], points[i]), first_of[i]));
        return hn::Mul(sum, all(degree));
    }
    HWY_INLINE Double second(const Double* points) const {
        Double sum = hn::Mul(points[0], all(0.0));
        for (int i = 0; i + 1 < degree; ++i)
            sum =
                hn::Add(sum, hn::Mul(hn::Sub(hn::Sub(points[i + 2], points[i + 1]), hn::Sub(points[i + 1], points[i])),
                                     second_of[i]));
        return hn::Mul(sum, all(degree * (degree - 1)));
    }
};
