// Directions across a curve: Blender's initial direction, and how it is carried along without twist.
#pragma once

#include "base/vector.h"

namespace rayleaf {

/// The unit vector N of the frame (N, B, T) that looks up: N = z x T, so that B = T x N leans towards +z. For T along
/// +-z, Blender's choice.
Vec3d upright_normal(const Vec3d& tangent);

/// `across` (perpendicular to unit `from`) turned by the smallest rotation that takes `from` to unit `to`. For opposite
/// directions `across` itself.
Vec3d carried(const Vec3d& from, const Vec3d& to, const Vec3d& across);

/// Directions whose sum with 1 is smaller are opposite, and parts across a tangent that are shorter are nothing.
inline constexpr double kOpposite = 1e-12, kNoPart = 1e-9;

/// The same and its derivative, as `to` changes by `to_change`.
struct CarriedNormal {
    Vec3d value, change;
};
CarriedNormal carried(const Vec3d& from, const Vec3d& to, const Vec3d& to_change, const Vec3d& across);

/// The unit vector nearest to `across` that is perpendicular to unit `tangent`.
Vec3d perpendicular(const Vec3d& across, const Vec3d& tangent);

/// A point of a curve with its unit tangent.
struct CurveStation {
    Vec3d position, tangent;
};

/// `across` carried from one station to the next of a rotation minimizing frame: two reflections, with an error of the
/// fourth order in the stations' distance (Wang, Juettler, Zheng, Liu, "Computation of Rotation Minimizing Frames", ACM
/// TOG 27(1), 2008, section 4).
Vec3d doubly_reflected(const CurveStation& from, const CurveStation& to, const Vec3d& across);

/// The angle about `tangent` that turns `from` into `to`, both perpendicular to it; -pi to pi.
double angle_about(const Vec3d& tangent, const Vec3d& from, const Vec3d& to);

struct CosineAndSine {
    double cosine, sine;
};
/// One function, so that all callers get the same bits.
CosineAndSine cosine_and_sine(double angle);

/// `across` (perpendicular to unit `tangent`) turned about it.
Vec3d turned(const Vec3d& tangent, const Vec3d& across, double angle);

}  // namespace rayleaf
