#include "integrators/hemisphere_record.h"

namespace rayleaf {
namespace {

/// One number for how large a light is: channels that are colours of irradiance, or of a share scaled as such.
float size_of(const HemisphereLight& light) {
    return luminance(light.direct + light.indirect);
}

/// `a` less `b`.
HemisphereLight difference(const HemisphereLight& a, const HemisphereLight& b) {
    HemisphereLight result = a;
    return result += b * -1.0f;
}

/// Sum over the grid of the two gradients in the hemisphere's own frame (z its pole).
class GradientSums {
  public:
    GradientSums(const HemisphereGrid& grid, const std::vector<HemisphereRay>& rays) : grid_(grid), rays_(rays) {
        for (int ring = 0; ring < grid.rings; ++ring)
            for (int sector = 0; sector < grid.sectors; ++sector) add_cell(ring, sector);
    }

    HemisphereGradient turning, moving;

  private:
    const HemisphereGrid& grid_;
    const std::vector<HemisphereRay>& rays_;

    const HemisphereRay& ray(int ring, int sector) const {
        return rays_[static_cast<size_t>(ring) * static_cast<size_t>(grid_.sectors) + static_cast<size_t>(sector)];
    }
    /// sin² of a border or, with a half, of the middle of a ring.
    float sine_squared(float ring) const { return ring / static_cast<float>(grid_.rings); }
    Vec3f horizontal(float sector) const {
        const float angle = 2.0f * kPi * sector / static_cast<float>(grid_.sectors);
        return {std::cos(angle), std::sin(angle), 0.0f};
    }

    void add_cell(int ring, int sector) {
        const auto j = static_cast<float>(ring), k = static_cast<float>(sector);
        const HemisphereRay& own = ray(ring, sector);
        const float middle = sine_squared(j + 0.5f);
        const Vec3f outward = horizontal(k + 0.5f), along = Vec3f(-outward.y, outward.x, 0.0f);
        // The integral of radiance times pole x direction, in cells of cosine-weighted measure pi / size.
        const float tangent = std::sqrt(middle / (1.0f - middle));
        turning.add(along * (kPi / static_cast<float>(grid_.size()) * tangent), own.light);

        const HemisphereRay& before = ray(ring, (sector + grid_.sectors - 1) % grid_.sectors);
        const float height = std::sqrt(sine_squared(j + 1.0f)) - std::sqrt(sine_squared(j));
        const Vec3f border = horizontal(k);
        moving.add(Vec3f(-border.y, border.x, 0.0f) * (height * nearer(own, before)),
                   difference(own.light, before.light));
        if (ring == 0) return;
        const HemisphereRay& inner = ray(ring - 1, sector);
        const float border2 = sine_squared(j), width = 2.0f * kPi / static_cast<float>(grid_.sectors);
        moving.add(outward * (width * std::sqrt(border2) * (1.0f - border2) * nearer(own, inner)),
                   difference(own.light, inner.light));
    }
    static float nearer(const HemisphereRay& a, const HemisphereRay& b) {
        return std::max(a.inverse_distance, b.inverse_distance);
    }
};

/// The frame's gradient in world axes.
HemisphereGradient in_world(const HemisphereGradient& local, const Vec3f& x, const Vec3f& y, const Vec3f& z) {
    HemisphereGradient world;
    world.add(x, local.along[0]);
    world.add(y, local.along[1]);
    world.add(z, local.along[2]);
    return world;
}

/// Length of the gradient of `size_of` over that itself: the inverse of the distance to a full change.
float relative_change(const HemisphereGradient& gradient, const HemisphereLight& light) {
    const auto length = [&](auto measure) {
        return Vec3f(measure(gradient.along[0]), measure(gradient.along[1]), measure(gradient.along[2])).length();
    };
    const float irradiance = size_of(light), free = luminance(light.free);
    float change = 0.0f;
    if (irradiance > 0.0f) change = length(size_of) / irradiance;
    if (free > 0.0f)
        change = std::max(change, length([](const HemisphereLight& l) { return luminance(l.free); }) / free);
    return change;
}

}  // namespace

HemisphereLight& HemisphereLight::operator+=(const HemisphereLight& other) {
    direct += other.direct;
    indirect += other.indirect;
    free += other.free;
    return *this;
}

HemisphereLight HemisphereLight::operator*(float factor) const {
    return {direct * factor, indirect * factor, free * factor};
}

void HemisphereGradient::add(const Vec3f& axis, const HemisphereLight& change) {
    for (size_t i = 0; i < along.size(); ++i) along[i] += change * axis[static_cast<int>(i)];
}

HemisphereLight HemisphereGradient::dot(const Vec3f& step) const {
    HemisphereLight sum = along[0] * step.x;
    sum += along[1] * step.y;
    sum += along[2] * step.z;
    return sum;
}

HemisphereGrid::HemisphereGrid(int rays) {
    const auto count = static_cast<float>(rays);
    rings = std::max(2, static_cast<int>(std::lround(std::sqrt(count / kPi))));
    sectors = std::max(4, static_cast<int>(std::lround(count / static_cast<float>(rings))));
}

Vec3f HemisphereGrid::direction(int index, const Vec2f& random) const {
    const int ring = index / sectors;
    const float sine2 = (static_cast<float>(ring) + random.x) / static_cast<float>(rings);
    const float angle = 2.0f * kPi * (static_cast<float>(index % sectors) + random.y) / static_cast<float>(sectors);
    const float sine = std::sqrt(sine2);
    return {sine * std::cos(angle), sine * std::sin(angle), std::sqrt(std::max(0.0f, 1.0f - sine2))};
}

HemisphereRecord make_record(const Vec3d& position, const Vec3f& normal, const HemisphereGrid& grid,
                             const std::vector<HemisphereRay>& rays, const RadiusLimits& limits) {
    HemisphereRecord record;
    record.position = position;
    record.normal = normal;
    float nearness = 0.0f;
    for (const HemisphereRay& ray : rays) {
        record.light += ray.light;
        nearness += ray.inverse_distance;
    }
    const auto count = static_cast<float>(rays.size());
    record.light = record.light * (kPi / count);
    record.harmonic_distance = count / nearness;
    Vec3f x, y;
    orthonormal_basis(normal, x, y);
    const GradientSums sums(grid, rays);
    record.turning = in_world(sums.turning, x, y, normal);
    record.moving = in_world(sums.moving, x, y, normal);

    const float wanted = std::min(record.harmonic_distance, 1.0f / relative_change(record.moving, record.light));
    record.radius = std::clamp(wanted, limits.least, limits.most);
    if (wanted < record.radius)
        for (HemisphereLight& change : record.moving.along) change = change * (wanted / record.radius);
    return record;
}

}  // namespace rayleaf
