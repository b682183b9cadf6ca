#include "rays/motion.h"

#include <optional>

#include <ImathMatrixAlgo.h>
#include <ImathQuat.h>

namespace rayleaf {
namespace {

bool is_finite_map(const Affine3d& m) {
    return is_finite(m.x) && is_finite(m.y) && is_finite(m.z);
}

/// The rotation of a map's polar decomposition by Newton's iteration (Higham 1986), mirrored where the map mirrors;
/// empty where the map is flat.
std::optional<Affine3d> rotation_of(const Affine3d& map) {
    constexpr int kMostSteps = 100;
    constexpr double kConverged = 1e-15;
    const double size = std::max({max_abs(map.x), max_abs(map.y), max_abs(map.z)});
    if (!(size > 0.0)) return std::nullopt;
    Affine3d q{map.x / size, map.y / size, map.z / size, Vec3d(0.0)};
    for (int step = 0; step < kMostSteps; ++step) {
        const double inverse = 1.0 / q.determinant();
        const Affine3d transposed{q.y.cross(q.z) * inverse, q.z.cross(q.x) * inverse, q.x.cross(q.y) * inverse,
                                  Vec3d(0.0)};
        const Affine3d next{(q.x + transposed.x) * 0.5, (q.y + transposed.y) * 0.5, (q.z + transposed.z) * 0.5,
                            Vec3d(0.0)};
        if (!is_finite_map(next)) return std::nullopt;
        const double change = std::max({max_abs(next.x - q.x), max_abs(next.y - q.y), max_abs(next.z - q.z)});
        q = next;
        if (change < kConverged) break;
    }
    if (q.determinant() < 0.0) q = {-q.x, -q.y, -q.z, Vec3d(0.0)};
    return q;
}

Imath::Quatd quaternion(const Vec4d& q) {
    return {q.x, q.y, q.z, q.w};
}

Vec4d quaternion_of(const Affine3d& r) {
    const Imath::M44d rows(r.x.x, r.x.y, r.x.z, 0, r.y.x, r.y.y, r.y.z, 0, r.z.x, r.z.y, r.z.z, 0, 0, 0, 0, 1);
    const Imath::Quatd q = Imath::extractQuat(rows).normalized();
    return {q.r, q.v.x, q.v.y, q.v.z};
}

/// A share of the way from one rotation to another, of unit quaternions.
Affine3d turned(const Vec4d& from, const Vec4d& to, double share) {
    const Imath::M33d rows = Imath::slerp(quaternion(from), quaternion(to), share).toMatrix33();
    return {Vec3d(rows[0][0], rows[0][1], rows[0][2]), Vec3d(rows[1][0], rows[1][1], rows[1][2]),
            Vec3d(rows[2][0], rows[2][1], rows[2][2]), Vec3d(0.0)};
}

Affine3d transposed(const Affine3d& m) {
    return {{m.x.x, m.y.x, m.z.x}, {m.x.y, m.y.y, m.z.y}, {m.x.z, m.y.z, m.z.z}, Vec3d(0.0)};
}

Vec3d mixed(const Vec3d& a, const Vec3d& b, double share) {
    return a * (1.0 - share) + b * share;
}

Affine3d mixed(const Affine3d& a, const Affine3d& b, double share) {
    return {mixed(a.x, b.x, share), mixed(a.y, b.y, share), mixed(a.z, b.z, share), Vec3d(0.0)};
}

Vec3d corner(const Box3d& box, int number) {
    return {(number & 1) != 0 ? box.max.x : box.min.x, (number & 2) != 0 ? box.max.y : box.min.y,
            (number & 4) != 0 ? box.max.z : box.min.z};
}

}  // namespace

StepShare step_share(float time, size_t steps) {
    const size_t last = steps - 1;
    const double place = static_cast<double>(shutter_time(time)) * static_cast<double>(last);
    const size_t first = std::min(static_cast<size_t>(place), last - 1);
    return {first, place - static_cast<double>(first)};
}

Motion::Motion(std::span<const Affine3d> places) {
    const bool turns =
        std::all_of(places.begin(), places.end(), [](const Affine3d& place) { return rotation_of(place).has_value(); });
    keys_.reserve(places.size());
    for (const Affine3d& place : places) add(place, turns);
}

void Motion::add(const Affine3d& place, bool turns) {
    Key key;
    key.translation = place.translation;
    key.rest = {place.x, place.y, place.z, Vec3d(0.0)};
    if (turns) {
        const Affine3d rotation = *rotation_of(place);
        key.rotation = quaternion_of(rotation);
        key.rest = transposed(rotation) * key.rest;
    }
    if (!keys_.empty()) {
        Key& last = keys_.back();
        if (last.rotation.dot(key.rotation) < 0.0) key.rotation = -key.rotation;  // the same rotation
        last.half_turn = Imath::angle4D(quaternion(last.rotation), quaternion(key.rotation));
    }
    keys_.push_back(key);
}

Affine3d Motion::at(float time) const {
    const StepShare step = step_share(time, keys_.size());
    return between(step.first, step.share);
}

Affine3d Motion::between(size_t first, double share) const {
    const Key &a = keys_[first], &b = keys_[first + 1];
    Affine3d map = turned(a.rotation, b.rotation, share) * mixed(a.rest, b.rest, share);
    map.translation = mixed(a.translation, b.translation, share);
    return map;
}

Box3d Motion::bounds(const Box3d& box) const {
    Box3d bounds;
    if (box.isEmpty()) return bounds;
    for (size_t first = 0; first + 1 < keys_.size(); ++first) add_bounds(first, box, bounds);
    return bounds;
}

/// A corner's way p(s) = R(s) q(s) + T(s), with q and T along lines and R turning by `turn`, lies within max|p''| / 8
/// n² of the chords between n + 1 points of it; |p''| <= turn² |q| + 2 turn |q'|.
void Motion::add_bounds(size_t first, const Box3d& box, Box3d& bounds) const {
    constexpr double kStep = 0.1;       // radians between two points of the way
    constexpr double kRounding = 1e-9;  // of what is added up, for rounding
    const Key &a = keys_[first], &b = keys_[first + 1];
    const double turn = 2.0 * a.half_turn;
    const int steps = 1 + static_cast<int>(turn / kStep);
    double bend = 0.0, size = 0.0;
    for (int number = 0; number < 8; ++number) {
        const Vec3d from = a.rest.vector(corner(box, number)), to = b.rest.vector(corner(box, number));
        const double farthest = std::max(from.length(), to.length());
        bend = std::max(bend, turn * turn * farthest + 2.0 * turn * (to - from).length());
        size = std::max(size, farthest);
    }
    const Vec3d margin(bend / (8.0 * steps * steps) + kRounding * size);
    for (int step = 0; step <= steps; ++step) {
        const Affine3d map = between(first, static_cast<double>(step) / steps);
        for (int number = 0; number < 8; ++number) {
            const Vec3d point = map.point(corner(box, number));
            bounds.extendBy(point - margin);
            bounds.extendBy(point + margin);
        }
    }
}

}  // namespace rayleaf
