#include "integrators/scattered_differential.h"

namespace rayleaf {
namespace {

/// Opening of the widest lobe, radians: about the root of pi / kPathSiblings, the share of a cosine-weighted hemisphere
/// at its pole.
constexpr float kWidestLobe = 0.5f;

/// Change of the texture coordinates for a step `dp` on the surface, by least squares.
Vec2f parameter_step(const SurfacePoint& point, const Vec3f& dp) {
    const float uu = point.dp_du.length2(), uv = point.dp_du.dot(point.dp_dv), vv = point.dp_dv.length2();
    const float determinant = uu * vv - uv * uv;
    if (!(determinant > 0.0f)) return Vec2f(0.0f);
    const float u = point.dp_du.dot(dp), v = point.dp_dv.dot(dp);
    const Vec2f step((vv * u - uv * v) / determinant, (uu * v - uv * u) / determinant);
    return std::isfinite(step.x) && std::isfinite(step.y) ? step : Vec2f(0.0f);
}

Vec3f normal_step(const SurfacePoint& point, const Vec3f& dp) {
    const Vec2f step = parameter_step(point, dp);
    const Vec3f dn = point.dn_du * step.x + point.dn_dv * step.y;
    return is_finite(dn) ? dn : Vec3f(0.0f);
}

/// The normal at which the lobe mirrored or refracted, facing the incoming side.
Vec3f microfacet_normal(const Vec3f& direction, const SurfacePoint& point, const LobeSample& sample) {
    const Vec3f otherwise = point.normal.dot(direction) < 0.0f ? point.normal : -point.normal;
    const Vec3f sum = sample.transmitted ? direction * sample.eta - sample.direction : sample.direction - direction;
    const Vec3f normal = normalized_or(sum, otherwise);
    return normal.dot(direction) < 0.0f ? normal : -normal;
}

/// By the curvature of the surface alone.
RayDifferential curved(const RayDifferential& differential, const Vec3f& direction, const SurfacePoint& point,
                       const LobeSample& sample) {
    const Vec3f normal = microfacet_normal(direction, point, sample);
    const float side = point.normal.dot(normal) < 0.0f ? -1.0f : 1.0f;
    const Vec3f dn_dx = normal_step(point, differential.dp_dx) * side;
    const Vec3f dn_dy = normal_step(point, differential.dp_dy) * side;
    return sample.transmitted ? refracted(differential, direction, normal, dn_dx, dn_dy, sample.eta)
                              : reflected(differential, direction, normal, dn_dx, dn_dy);
}

/// Change of a unit direction towards a point `distance` away when its start moves by `dp`.
Vec3f aim_change(const Vec3f& direction, double distance, const Vec3f& dp) {
    return (direction * direction.dot(dp) - dp) / static_cast<float>(distance);
}

}  // namespace

RayDifferential scattered_differential(const RayDifferential& differential, const Vec3f& direction,
                                       const SurfacePoint& point, const LobeSample& sample) {
    if (sample.kind == LobeKind::Diffuse || sample.fibre) return widened(differential, sample.direction, kWidestLobe);
    RayDifferential mirrored = curved(differential, direction, point, sample);
    if (sample.roughness <= 0.0f) return mirrored;
    return widened(mirrored, sample.direction, kWidestLobe * sample.roughness);
}

RayDifferential glossy_differential(const RayDifferential& differential, const Vec3f& direction,
                                    const SurfacePoint& point, const LobeSample& sample, int rays) {
    RayDifferential mirrored = curved(differential, direction, point, sample);
    if (sample.singular) return mirrored;
    const float width = share_width(sample.density, rays);
    return width > mirrored.angle() ? widened(mirrored, sample.direction, width) : mirrored;
}

RayDifferential hemisphere_differential(const RayDifferential& differential, const Vec3f& direction, float cosine,
                                        int rays) {
    RayDifferential shared = differential;
    shared.dd_dx = shared.dd_dy = Vec3f(0.0f);
    return widened(shared, direction, share_width(cosine / kPi, rays));
}

RayDifferential shadow_differential(const RayDifferential& differential, const LightSample& light, int rays) {
    RayDifferential towards = differential;
    towards.dd_dx = towards.dd_dy = Vec3f(0.0f);
    if (std::isfinite(light.distance)) {
        towards.dd_dx = aim_change(light.direction, light.distance, differential.dp_dx);
        towards.dd_dy = aim_change(light.direction, light.distance, differential.dp_dy);
    }
    if (light.delta) return towards;
    const float width = share_width(light.density, rays);
    return width > towards.angle() ? widened(towards, light.direction, width) : towards;
}

}  // namespace rayleaf
