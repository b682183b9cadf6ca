// Vectors, boxes and matrices: short names for the Imath types, and the few functions Imath lacks.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include <ImathBox.h>
#include <ImathMatrix.h>
#include <ImathVec.h>

namespace rayleaf {

// Imath leaves default-constructed vectors uninitialized: members of these types name their initial value.
using Vec2f = Imath::V2f;
using Vec2d = Imath::V2d;
using Vec3f = Imath::V3f;
using Vec3d = Imath::V3d;
using Vec3i = Imath::V3i;
using Vec4f = Imath::V4f;
using Vec4d = Imath::V4d;
using Box3f = Imath::Box3f;
using Box3d = Imath::Box3d;

constexpr float kPi = std::numbers::pi_v<float>;

/// Linear scene-referred colour with Rec. 709 primaries, no unit of its own.
using Color = Vec3f;

inline float luminance(const Color& c) {
    return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}
inline float average(const Color& c) {
    return (c.x + c.y + c.z) * (1.0f / 3.0f);
}
inline float max_component(const Vec3f& v) {
    return std::max(v.x, std::max(v.y, v.z));
}
inline double max_component(const Vec3d& v) {
    return std::max(v.x, std::max(v.y, v.z));
}
inline float max_abs(const Vec3f& v) {
    return std::max(std::abs(v.x), std::max(std::abs(v.y), std::abs(v.z)));
}
inline double max_abs(const Vec3d& v) {
    return std::max(std::abs(v.x), std::max(std::abs(v.y), std::abs(v.z)));
}
inline bool is_black(const Color& c) {
    return c.x == 0.0f && c.y == 0.0f && c.z == 0.0f;
}

template <typename T>
bool is_finite(const Imath::Vec3<T>& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// A vector of floats; zero if a component overflows: such derivatives are useless.
inline Vec3f float_or_zero(const Vec3d& v) {
    const Vec3f result(v);
    return is_finite(result) ? result : Vec3f(0.0f);
}

/// The unit vector along `v`, or `otherwise` where `v` is zero, not finite, or too short to have a direction.
template <typename T>
Imath::Vec3<T> normalized_or(const Imath::Vec3<T>& v, const Imath::Vec3<T>& otherwise) {
    const T largest = max_abs(v);
    if (!(largest > T(0)) || !std::isfinite(largest)) return otherwise;
    const Imath::Vec3<T> scaled = v / largest;
    const T length = std::sqrt(scaled.dot(scaled));
    return scaled / length;
}

inline float finite_or_zero(float x) {
    return std::isfinite(x) ? x : 0.0f;
}

/// Two unit vectors that complete unit `n` to a right-handed orthonormal frame (Duff et al. 2017, revised ONB).
inline void orthonormal_basis(const Vec3f& n, Vec3f& tangent, Vec3f& bitangent) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    tangent = Vec3f(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
    bitangent = Vec3f(b, sign + n.y * n.y * a, -n.y);
}

/// An affine map p -> linear * p + translation in double precision, columns as Blender's matrix_world has them.
struct Affine3d {
    Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};  ///< images of the unit axes
    Vec3d translation{0, 0, 0};

    bool operator==(const Affine3d&) const = default;
    Vec3d vector(const Vec3d& v) const { return x * v.x + y * v.y + z * v.z; }
    Vec3d point(const Vec3d& p) const { return vector(p) + translation; }
    double determinant() const { return x.dot(y.cross(z)); }
    /// Image of a normal (a covector): the inverse transpose applied by cofactors, so it needs no inverse. Not unit.
    /// Points to the side of the mapped winding: a mirroring map reverses it.
    Vec3d normal(const Vec3d& n) const { return y.cross(z) * n.x + z.cross(x) * n.y + x.cross(y) * n.z; }
    /// The same, but it stays on its side of the surface: a mirroring map does not reverse it.
    Vec3d outward(const Vec3d& n) const { return determinant() < 0.0 ? -normal(n) : normal(n); }
    /// The inverse map; the linear part must be regular.
    Affine3d inverse() const {
        const double d = 1.0 / determinant();
        const Vec3d r0 = y.cross(z) * d, r1 = z.cross(x) * d, r2 = x.cross(y) * d;
        Affine3d out{{r0.x, r1.x, r2.x}, {r0.y, r1.y, r2.y}, {r0.z, r1.z, r2.z}, {}};
        out.translation = -out.vector(translation);
        return out;
    }
};

/// The map "first `inner`, then `outer`".
inline Affine3d operator*(const Affine3d& outer, const Affine3d& inner) {
    return {outer.vector(inner.x), outer.vector(inner.y), outer.vector(inner.z), outer.point(inner.translation)};
}

/// Half the area of its surface.
inline double half_area(const Box3d& box) {
    const Vec3d size = box.max - box.min;
    return size.x * size.y + size.y * size.z + size.z * size.x;
}

/// Bounds of a box's image.
inline Box3d image_of(const Box3d& box, const Affine3d& map) {
    if (box.isEmpty()) return {};
    const Vec3d center = map.point((box.min + box.max) * 0.5), half = (box.max - box.min) * 0.5;
    Vec3d reach(0.0);
    for (int axis = 0; axis < 3; ++axis)
        reach[axis] = std::abs(map.x[axis]) * half.x + std::abs(map.y[axis]) * half.y + std::abs(map.z[axis]) * half.z;
    return {center - reach, center + reach};
}

}  // namespace rayleaf
