// Derivatives of an output ray by its line, carried along the path from hit to hit.
//
// Igehy, Tracing Ray Differentials (1999), with the four parameters of the line instead of a pixel's two, in double
// precision, and without the limits that keep a texture's footprint useful.
#pragma once

#include "geometry/shape.h"
#include "ri_tree/line_space.h"
#include "ri_tree/output_ray.h"

#include <array>

namespace rayleaf {

/// Derivatives of a ray by one parameter: of a point on it, and of its unit direction.
struct RayChange {
    Vec3d position{0, 0, 0}, direction{0, 0, 0};
};
using RayChanges = std::array<RayChange, kLineAxes>;

/// Derivatives of an output ray by one parameter. Zero where the kind does not have the attribute.
struct OutputChange {
    Vec3d position{0, 0, 0}, normal{0, 0, 0};
    Vec2d uv{0, 0};
    Vec3d exit_position{0, 0, 0}, exit_direction{0, 0, 0};
    double length = 0;
};
using OutputChanges = std::array<OutputChange, kLineAxes>;

/// For paths without derivatives.
class UnknownChanges {
  public:
    void arrive(const Vec3d&, const Vec3d&, const LocalSurface&, const Vec3d&) {}
    void first_hit() {}
    void refract(const Vec3d&, const Vec3d&, double, bool) {}
    void reflect(const Vec3d&, const Vec3d&, bool) {}
    void leave() {}
    void cut_off() {}
    void add_crossing(const Vec3d&, double, const Vec3d&, double) {}
};

class PathChanges {
  public:
    /// `ray` are the derivatives at `origin`, a point of the ray.
    PathChanges(const Vec3d& origin, const RayChanges& ray, OutputChanges& out)
        : point_(origin), ray_(ray), out_(out) {}

    /// Moves on along `direction` to `position`, on a surface whose tangent plane has `tangent_normal`.
    void arrive(const Vec3d& position, const Vec3d& direction, const LocalSurface& surface,
                const Vec3d& tangent_normal) {
        const double distance = (position - point_).dot(direction);
        const double cosine = direction.dot(tangent_normal);
        const Vec3d by_u(surface.dp_du), by_v(surface.dp_dv);
        const double uu = by_u.dot(by_u), uv = by_u.dot(by_v), vv = by_v.dot(by_v), area = uu * vv - uv * uv;
        for (int k = 0; k < kLineAxes; ++k) {
            const Vec3d moved = ray_[k].position + ray_[k].direction * distance;
            ray_[k].position = moved - direction * (moved.dot(tangent_normal) / cosine);
            const double u = by_u.dot(ray_[k].position), v = by_v.dot(ray_[k].position);
            uv_[k] = area > 0.0 ? Vec2d((vv * u - uv * v) / area, (uu * v - uv * u) / area) : Vec2d(0, 0);
            normal_[k] = Vec3d(surface.dn_du) * uv_[k].x + Vec3d(surface.dn_dv) * uv_[k].y;
        }
        point_ = position;
    }

    /// The point arrived at is the first.
    void first_hit() {
        for (int k = 0; k < kLineAxes; ++k) {
            out_[k].position = out_[k].exit_position = ray_[k].position;
            out_[k].normal = normal_[k];
            out_[k].uv = uv_[k];
        }
    }

    /// `facing` is the unit normal on the incoming side; `turned`: it is opposite to the surface's normal.
    void refract(const Vec3d& direction, const Vec3d& facing, double eta, bool turned) {
        const double cosine = -direction.dot(facing);
        const double beyond = std::sqrt(1.0 - eta * eta * (1.0 - cosine * cosine));
        for (int k = 0; k < kLineAxes; ++k) {
            const Vec3d normal = turned ? -normal_[k] : normal_[k];
            const double by_cosine = -(ray_[k].direction.dot(facing) + direction.dot(normal));
            const double by_beyond = eta * eta * cosine * by_cosine / beyond;
            ray_[k].direction =
                ray_[k].direction * eta + facing * (eta * by_cosine - by_beyond) + normal * (eta * cosine - beyond);
        }
    }
    void reflect(const Vec3d& direction, const Vec3d& facing, bool turned) {
        for (int k = 0; k < kLineAxes; ++k) {
            const Vec3d normal = turned ? -normal_[k] : normal_[k];
            const double by_cosine = ray_[k].direction.dot(facing) + direction.dot(normal);
            ray_[k].direction -= (facing * by_cosine + normal * direction.dot(facing)) * 2.0;
        }
    }
    /// The path ends with the direction that the last refraction or reflection gave.
    void leave() {
        for (int k = 0; k < kLineAxes; ++k) {
            out_[k].exit_position = ray_[k].position;
            out_[k].exit_direction = ray_[k].direction;
        }
    }

    /// The path ends inside: position and normal of the first hit take the place of the ray that leaves.
    void cut_off() {
        for (int k = 0; k < kLineAxes; ++k) {
            out_[k].exit_position = out_[k].position;
            out_[k].exit_direction = out_[k].normal;
        }
    }

    /// The straight line crosses a facet at `t`; the length inside changes by `weight` times that.
    void add_crossing(const Vec3d& direction, double t, const Vec3d& facet_normal, double weight) {
        for (int k = 0; k < kLineAxes; ++k)
            out_[k].length -=
                weight * facet_normal.dot(ray_[k].position + ray_[k].direction * t) / facet_normal.dot(direction);
    }

  private:
    Vec3d point_;
    RayChanges ray_;
    OutputChanges& out_;
    std::array<Vec3d, kLineAxes> normal_;
    std::array<Vec2d, kLineAxes> uv_;
};

}  // namespace rayleaf
