// Parts of distribution ray tracing on arrays, for tests: a submodule.
#include "base/random.h"
#include "integrators/hemisphere_record.h"
#include "integrators/scattered_differential.h"
#include "python/bindings.h"
#include "python/differential_rows.h"

namespace rayleaf {
namespace {

/// Of a normal, dp_du, dp_dv, dn_du, dn_dv.
SurfacePoint surface_point(const std::array<Vector, 5>& surface) {
    SurfacePoint point;
    point.normal = point.facet_normal = vec(surface[0]);
    point.dp_du = vec(surface[1]);
    point.dp_dv = vec(surface[2]);
    point.dn_du = vec(surface[3]);
    point.dn_dv = vec(surface[4]);
    return point;
}

Rows glossy(const Rows& incoming, const Vector& direction, const std::array<Vector, 5>& surface,
            const Vector& scattered, float density, float eta, int rays) {
    const SurfacePoint point = surface_point(surface);
    LobeSample sample;
    sample.direction = vec(scattered);
    sample.kind = LobeKind::Glossy;
    sample.density = density;
    sample.singular = density == 0.0f;
    sample.transmitted = point.normal.dot(vec(direction)) * point.normal.dot(sample.direction) > 0.0f;
    sample.eta = eta;
    return rows(glossy_differential(differential(incoming), vec(direction), point, sample, rays));
}

Rows path(const Rows& incoming, const Vector& direction, const std::array<Vector, 5>& surface, const Vector& scattered,
          float roughness, bool diffuse) {
    const SurfacePoint point = surface_point(surface);
    LobeSample sample;
    sample.direction = vec(scattered);
    sample.kind = diffuse ? LobeKind::Diffuse : LobeKind::Glossy;
    sample.roughness = roughness;
    return rows(scattered_differential(differential(incoming), vec(direction), point, sample));
}

Rows shadow(const Rows& incoming, const Vector& direction, double distance, float density, bool delta, int rays) {
    LightSample light;
    light.direction = vec(direction);
    light.distance = distance;
    light.density = density;
    light.delta = delta;
    return rows(shadow_differential(differential(incoming), light, rays));
}

py::array_t<float> hemisphere_directions(int rays, const Array<float>& random) {
    const HemisphereGrid grid(rays);
    check_shape("hemisphere", "random", random, {grid.size(), 2});
    py::array_t<float> directions({py::ssize_t{grid.size()}, py::ssize_t{3}});
    auto out = directions.mutable_unchecked<2>();
    for (int i = 0; i < grid.size(); ++i) {
        const Vec3f direction = grid.direction(i, Vec2f(random.data()[2 * i], random.data()[2 * i + 1]));
        for (int axis = 0; axis < 3; ++axis) out(i, axis) = direction[axis];
    }
    return directions;
}

py::dict hemisphere_record(int count, const Vector& normal, const Array<float>& radiance, const Array<float>& distance,
                           const std::array<float, 2>& radius_limits) {
    using namespace py::literals;
    const HemisphereGrid grid(count);
    check_shape("hemisphere", "radiance", radiance, {grid.size()});
    check_shape("hemisphere", "distance", distance, {grid.size()});
    std::vector<HemisphereRay> rays(static_cast<size_t>(grid.size()));
    for (size_t i = 0; i < rays.size(); ++i)
        rays[i] = {{Color(0.0f), Color(radiance.data()[i]), Color(1.0f)}, 1.0f / distance.data()[i]};
    const HemisphereRecord record =
        make_record(Vec3d(0.0), vec(normal), grid, rays, {radius_limits[0], radius_limits[1]});
    const auto gradient = [](const HemisphereGradient& g) {
        return Vector{g.along[0].indirect.x, g.along[1].indirect.x, g.along[2].indirect.x};
    };
    return py::dict("irradiance"_a = record.light.indirect.x, "turning"_a = gradient(record.turning),
                    "moving"_a = gradient(record.moving), "radius"_a = record.radius,
                    "harmonic_distance"_a = record.harmonic_distance);
}

py::array_t<float> branch_pairs(uint32_t pixel, uint32_t samples, uint32_t count, uint32_t tag, uint32_t dimension) {
    py::array_t<float> pairs({py::ssize_t{samples}, py::ssize_t{count}, py::ssize_t{2}});
    auto out = pairs.mutable_unchecked<3>();
    for (uint32_t s = 0; s < samples; ++s)
        for (uint32_t i = 0; i < count; ++i) {
            const Vec2f pair = Sampler(pixel, s, 0).branch(i, count, tag).get2(dimension);
            out(s, i, 0) = pair.x;
            out(s, i, 1) = pair.y;
        }
    return pairs;
}

}  // namespace

void bind_distribution(py::module_& parent) {
    using namespace py::literals;
    py::module_ module =
        parent.def_submodule("distribution", "Parts of distribution ray tracing on arrays, for tests.");
    module.def("glossy_differential", &glossy, "incoming"_a, "direction"_a, "surface"_a, "scattered"_a, "density"_a,
               "eta"_a, "rays"_a,
               "Differential of one of `rays` glossy rays; surface: normal, dp_du, dp_dv, dn_du, dn_dv; density 0: a "
               "mirror or clear refraction.");
    module.def("path_differential", &path, "incoming"_a, "direction"_a, "surface"_a, "scattered"_a, "roughness"_a,
               "diffuse"_a, "The same in path tracing, which goes on with one ray.");
    module.def(
        "hemisphere_differential",
        [](const Rows& incoming, const Vector& direction, float cosine, int rays) {
            return rows(hemisphere_differential(differential(incoming), vec(direction), cosine, rays));
        },
        "incoming"_a, "direction"_a, "cosine"_a, "rays"_a);
    module.def("shadow_differential", &shadow, "incoming"_a, "direction"_a, "distance"_a, "density"_a, "delta"_a,
               "rays"_a);
    module.def("hemisphere_directions", &hemisphere_directions, "rays"_a, "random"_a,
               "Directions about +z of the grid for about `rays` rays, ring by ring; random: (n, 2).");
    module.def(
        "hemisphere_shape",
        [](int rays) {
            const HemisphereGrid grid(rays);
            return std::make_pair(grid.rings, grid.sectors);
        },
        "rays"_a, "Rings and sectors of that grid.");
    module.def("hemisphere_record", &hemisphere_record, "rays"_a, "normal"_a, "radiance"_a, "distance"_a,
               "radius_limits"_a, "Irradiance and gradients from radiance and distance of each ray of the grid.");
    module.def("branch_pairs", &branch_pairs, "pixel"_a, "samples"_a, "count"_a, "tag"_a, "dimension"_a,
               "Random numbers of all sub-rays of a pixel: (samples, count, 2).");
}

}  // namespace rayleaf
