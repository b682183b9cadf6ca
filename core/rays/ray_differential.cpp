#include "rays/ray_differential.h"

#include "base/diagonal_basis.h"

namespace rayleaf {
namespace {

Vec3f transferred_position(const Vec3f& dp, const Vec3f& dd, const Vec3f& direction, float t, const Vec3f& normal) {
    const Vec3f moved = dp + dd * t;
    const float cosine = direction.dot(normal);
    // At a grazing hit the footprint grows without bound; filtering does not change beyond a factor of a
    // thousand.
    const float safe = std::copysign(std::max(std::abs(cosine), 1e-3f), cosine);
    return moved - direction * (moved.dot(normal) / safe);
}

}  // namespace

RayDifferential RayDifferential::transferred(const Vec3f& direction, double t, const Vec3f& normal) const {
    const auto distance = static_cast<float>(t);
    return {transferred_position(dp_dx, dd_dx, direction, distance, normal),
            transferred_position(dp_dy, dd_dy, direction, distance, normal), dd_dx, dd_dy};
}

RayDifferential reflected(const RayDifferential& in, const Vec3f& d, const Vec3f& n, const Vec3f& dn_dx,
                          const Vec3f& dn_dy) {
    const float dn = d.dot(n);
    const auto change = [&](const Vec3f& dd, const Vec3f& dnormal) {
        const float ddn = dd.dot(n) + d.dot(dnormal);
        return dd - (dnormal * dn + n * ddn) * 2.0f;
    };
    return {in.dp_dx, in.dp_dy, change(in.dd_dx, dn_dx), change(in.dd_dy, dn_dy)};
}

RayDifferential refracted(const RayDifferential& in, const Vec3f& d, const Vec3f& n, const Vec3f& dn_dx,
                          const Vec3f& dn_dy, float eta) {
    const float dn = d.dot(n);
    const float cos_out = -std::sqrt(std::max(1.0f - eta * eta * (1.0f - dn * dn), 1e-6f));
    const float mu = eta * dn - cos_out;
    const float dmu_factor = eta - eta * eta * dn / cos_out;
    const auto change = [&](const Vec3f& dd, const Vec3f& dnormal) {
        const float ddn = dd.dot(n) + d.dot(dnormal);
        return dd * eta - (dnormal * mu + n * (dmu_factor * ddn));
    };
    return {in.dp_dx, in.dp_dy, change(in.dd_dx, dn_dx), change(in.dd_dy, dn_dy)};
}

float share_width(float density, int rays) {
    constexpr float kWidest = 1.0f;
    const float shares = density * static_cast<float>(rays);
    return shares > 1.0f / (kWidest * kWidest) ? 1.0f / std::sqrt(shares) : kWidest;
}

RayDifferential RayDifferential::round_footprint(const Vec3f& direction, const Vec3f& normal) const {
    const auto across = [&](const Vec3f& dp) { return (dp - direction * dp.dot(direction)).length(); };
    const float width = 0.5f * (across(dp_dx) + across(dp_dy));
    RayDifferential result;
    diagonal_basis(normal, result.dp_dx, result.dp_dy);
    result.dp_dx *= width;
    result.dp_dy *= width;
    return result;
}

RayBeam RayDifferential::beam(const Vec3f& direction, const RayWidening& widening) const {
    const auto side = [&](const Vec3f& dp, const Vec3f& dd) {
        const Vec3f across = dp - direction * dp.dot(direction);
        const float squared = widening.factor * widening.factor;
        RayBeam::Side result{across.length2() * squared, 2 * across.dot(dd) * squared, dd.length2() * squared};
        const float least = widening.least_spread;
        if (result.c < least * least) result = {result.a, 2 * std::sqrt(result.a) * least, least * least};
        return result;
    };
    return {{side(dp_dx, dd_dx), side(dp_dy, dd_dy)}};
}

RayDifferential widened(const RayDifferential& in, const Vec3f& new_direction, float angle) {
    Vec3f tangent, bitangent;
    orthonormal_basis(new_direction, tangent, bitangent);
    const Vec3f across = in.dp_dx - new_direction * in.dp_dx.dot(new_direction);
    tangent = normalized_or(across, tangent);
    bitangent = new_direction.cross(tangent);
    const float wide = std::max(in.angle(), angle);
    return {in.dp_dx, in.dp_dy, tangent * wide, bitangent * std::copysign(wide, in.dp_dy.dot(bitangent))};
}

}  // namespace rayleaf
