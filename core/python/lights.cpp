#include "python/arrays.h"
#include "python/bindings.h"
#include "scene/scene.h"

namespace rayleaf {
namespace {

/// The lights of a scene, asked from a position as an integrator asks them.
class LightProbe {
  public:
    explicit LightProbe(const std::shared_ptr<SceneDescription>& description) : scene_(*description, settings()) {}

    const Scene& scene() const { return scene_; }

  private:
    Scene scene_;

    static Settings settings() {
        Settings settings;
        settings.width = settings.height = 1;
        return settings;
    }
};

Vec3d vector_of(const char* argument, const Array<double>& array) {
    check_shape("light probe", argument, array, {3});
    return {array.data()[0], array.data()[1], array.data()[2]};
}

LitPoint lit_point(const Array<double>& position, int64_t lit_by, const std::optional<Array<double>>& normal) {
    LitPoint point{vector_of("position", position), checked_light_sets("light probe", lit_by)};
    if (normal) point.normal = Vec3f(normalized_or(vector_of("normal", *normal), Vec3d(0.0)));
    return point;
}

py::array_t<float> colors(py::ssize_t count) {
    py::array_t<float> array({count, py::ssize_t{3}});
    std::fill_n(array.mutable_data(), 3 * count, 0.0f);
    return array;
}

py::dict sample(const LightProbe& probe, const Array<double>& position, const Array<float>& random, int64_t lit_by,
                const std::optional<Array<double>>& normal) {
    check_shape("light probe", "random", random, {-1, 2});
    LitPoint at = lit_point(position, lit_by, normal);
    const py::ssize_t count = random.shape(0);
    py::array_t<float> direction = colors(count), radiance = colors(count), density(count);
    py::array_t<double> distance(count);
    py::array_t<bool> delta(count);
    std::vector<LightQuery> queries;
    for (py::ssize_t i = 0; i < count; ++i) {
        const float* r = random.data() + 2 * i;
        queries.push_back({&at, Vec2f(r[0], r[1]), kMiddleTime, sampling_state(), {}});
    }
    probe.scene().lights().sample(queries);
    for (py::ssize_t i = 0; i < count; ++i) {
        const Maybe<LightSample>& found = queries[static_cast<size_t>(i)].light;
        const LightSample s = found ? *found : LightSample();
        for (int c = 0; c < 3; ++c) {
            direction.mutable_at(i, c) = s.direction[c];
            radiance.mutable_at(i, c) = s.radiance[c];
        }
        distance.mutable_at(i) = s.distance;
        density.mutable_at(i) = s.density;
        delta.mutable_at(i) = s.delta;
    }
    py::dict result;
    result["direction"] = direction;
    result["distance"] = distance;
    result["radiance"] = radiance;
    result["density"] = density;
    result["delta"] = delta;
    return result;
}

/// Everything that shines along one ray: all lamps on the way, then the emitting surface or the world.
std::pair<Color, float> look_along(const Scene& scene, const Ray& ray, const LitPoint& from) {
    Color radiance(0.0f);
    float density = 0;
    const Maybe<Hit> hit = scene.tracer().closest_hit(ray, kVisibleDiffuse);
    scene.lights().lamp_hits(ray, hit ? hit->t : ray.t_max, from, kVisibleDiffuse, sampling_state(),
                             [&](const LampHit& lamp) {
                                 radiance += lamp.radiance;
                                 density += lamp.density;
                             });
    const Vec3f direction(ray.direction);
    if (hit) {
        const SurfacePoint point = scene.tracer().surface_point(ray, *hit);
        Closures closures;
        scene.shade(point, -direction, {}, {}, closures);
        if (scene.shines_openly_on(from, point.instance)) radiance += closures.emission;
        density += scene.lights().emitter_density(from, point);
    } else {
        radiance += scene.world(direction, {}, {});
        density += scene.lights().world_density(direction, from);
    }
    return {radiance, density};
}

py::tuple look(const LightProbe& probe, const Array<double>& position, const Array<double>& directions, int64_t lit_by,
               const std::optional<Array<double>>& normal) {
    check_shape("light probe", "directions", directions, {-1, 3});
    const LitPoint at = lit_point(position, lit_by, normal);
    const py::ssize_t count = directions.shape(0);
    py::array_t<float> radiance = colors(count), density(count);
    for (py::ssize_t i = 0; i < count; ++i) {
        const double* d = directions.data() + 3 * i;
        Ray ray;
        ray.origin = at.position;
        ray.direction = normalized_or(Vec3d(d[0], d[1], d[2]), Vec3d(0, 0, 1));
        const auto [color, at_density] = look_along(probe.scene(), ray, at);
        for (int c = 0; c < 3; ++c) radiance.mutable_at(i, c) = color[c];
        density.mutable_at(i) = at_density;
    }
    return py::make_tuple(radiance, density);
}

}  // namespace

void bind_lights(py::module_& module) {
    using namespace py::literals;
    py::class_<LightProbe>(module, "LightProbe", "The lights of a scene, asked from a position.")
        .def(py::init<const std::shared_ptr<SceneDescription>&>(), py::arg("scene").none(false))
        .def("sample", &sample, "position"_a, "random"_a, "lit_by"_a = kAnyLight, "normal"_a = py::none(),
             "Light sampling for random numbers (n, 2): a dictionary of direction, distance, radiance, density, delta. "
             "A sample that carries nothing has density 0. `normal`: of a surface there that is lit from that side.")
        .def("look", &look, "position"_a, "directions"_a, "lit_by"_a = kAnyLight, "normal"_a = py::none(),
             "What shines from directions (n, 3): radiance (n, 3), and the density with which light sampling chooses "
             "the direction (n,).")
        .def(
            "count", [](const LightProbe& probe) { return probe.scene().lights().count(); },
            "How many lights there are: each lamp, emitting element, and the world if it is sampled.");
}

}  // namespace rayleaf
