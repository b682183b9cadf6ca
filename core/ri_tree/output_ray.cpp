#include "ri_tree/output_ray.h"

#include "ri_tree/snell.h"

namespace rayleaf {
namespace {

void store(const Vec3d& v, std::span<float> out, int first) {
    for (int i = 0; i < 3; ++i) out[first + i] = static_cast<float>(v[i]);
}

Vec3d vector_at(std::span<const double> values, int first) {
    return {values[first], values[first + 1], values[first + 2]};
}

/// Squared distance of two rays, at their starts and at `reach`.
double squared_ray_distance(const Vec3d& position_a, const Vec3d& direction_a, const Vec3d& position_b,
                            const Vec3d& direction_b, double reach) {
    const Vec3d start = position_a - position_b;
    return start.length2() + (start + (direction_a - direction_b) * reach).length2();
}

}  // namespace

int attribute_count(OutputKind kind) {
    switch (kind) {
        case OutputKind::Simple:
            return 8;
        case OutputKind::Mirror:
            return 6;
        case OutputKind::Glass:
            return 12;
        case OutputKind::Volume:
            return 1;
    }
    return 0;
}

void store_attributes(OutputKind kind, const OutputRay& ray, std::span<float> out) {
    if (kind == OutputKind::Volume) {
        out[0] = static_cast<float>(ray.length);
        return;
    }
    store(ray.position, out, 0);
    store(ray.normal, out, 3);
    if (kind == OutputKind::Simple) {
        out[6] = static_cast<float>(ray.uv.x);
        out[7] = static_cast<float>(ray.uv.y);
    } else if (kind == OutputKind::Glass) {
        store(ray.exit_position, out, 6);
        store(ray.exit_direction, out, 9);
    }
}

OutputRay from_attributes(OutputKind kind, const SampleClass& sample_class, std::span<const double> attributes,
                          const Vec3d& direction) {
    OutputRay ray;
    ray.sample_class = sample_class;
    if (kind == OutputKind::Volume) {
        ray.length = attributes[0];
        return ray;
    }
    ray.position = vector_at(attributes, 0);
    ray.normal = normalized_or(vector_at(attributes, 3), -direction);
    ray.exit_position = ray.position;
    ray.exit_direction = ray.normal;
    if (kind == OutputKind::Simple) {
        ray.uv = {attributes[6], attributes[7]};
    } else if (kind == OutputKind::Mirror) {
        ray.exit_direction = mirrored(direction, ray.normal);
    } else {
        ray.exit_position = vector_at(attributes, 6);
        ray.exit_direction = normalized_or(vector_at(attributes, 9), direction);
    }
    return ray;
}

double distance(OutputKind kind, const OutputRay& a, const OutputRay& b, double reach) {
    if (kind == OutputKind::Volume) return std::abs(a.length - b.length);
    double squared = squared_ray_distance(a.exit_position, a.exit_direction, b.exit_position, b.exit_direction, reach);
    if (kind == OutputKind::Simple) squared += (a.uv - b.uv).length2() * reach * reach;
    if (kind == OutputKind::Glass)
        squared = std::max(squared, squared_ray_distance(a.position, a.normal, b.position, b.normal, reach));
    return std::sqrt(squared);
}

Vec3d mirrored(const Vec3d& direction, const Vec3d& normal) {
    return reflected_direction(direction, normal);
}

std::optional<Vec3d> refracted_direction(const Vec3d& direction, const Vec3d& normal, double eta) {
    const std::optional<Vec3d> through = refracted_by_snell(direction, normal, eta);
    if (!through) return std::nullopt;
    return normalized_or(*through, direction);
}

}  // namespace rayleaf
