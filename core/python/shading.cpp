// Shader programs; and, in the submodule `shading`, what tests need to run them and their closures on arrays.
#include "python/arrays.h"
#include "python/bindings.h"
#include "shading/program.h"
#include "textures/texture_store.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace rayleaf {
namespace {

using Floats = Array<float>;
using OptionalFloats = std::optional<Floats>;

Vec3f row_of(const Floats& rows, size_t i) {
    const float* row = rows.data() + 3 * i;
    return {row[0], row[1], row[2]};
}
Vec2f pair(const Floats& rows, size_t i) {
    const float* row = rows.data() + 2 * i;
    return {row[0], row[1]};
}
void put(Floats& rows, size_t i, const Vec3f& v) {
    float* row = rows.mutable_data() + 3 * i;
    row[0] = v.x;
    row[1] = v.y;
    row[2] = v.z;
}
void put(Floats& rows, size_t i, const Vec4f& v) {
    float* row = rows.mutable_data() + 4 * i;
    row[0] = v.x;
    row[1] = v.y;
    row[2] = v.z;
    row[3] = v.w;
}
Floats rows(size_t count, py::ssize_t width) {
    return Floats({static_cast<py::ssize_t>(count), width});
}

/// Points to shade, as arrays; what is not given is zero, or derived from what is.
class ShadingPoints {
  public:
    std::vector<SurfacePoint> points;  ///< empty: directions into the world
    std::vector<ShadingInputs> inputs;
    std::shared_ptr<TextureStore> textures;
    InstanceInfo instance;

    ShadingPoints() = default;
    ShadingPoints(const ShadingPoints&) = delete;
    ShadingPoints& operator=(const ShadingPoints&) = delete;
};

void check_rows(const char* argument, const OptionalFloats& array, size_t count, py::ssize_t width) {
    if (array) check_shape("shading points", argument, *array, {static_cast<py::ssize_t>(count), width});
}

std::unique_ptr<ShadingPoints> surface_points(const Floats& position, const Floats& normal, const Floats& outgoing,
                                              const OptionalFloats& uv, const OptionalFloats& facet_normal,
                                              const OptionalFloats& dp_du, const OptionalFloats& dp_dv,
                                              const OptionalFloats& dp_dx, const OptionalFloats& dp_dy,
                                              std::shared_ptr<TextureStore> textures,
                                              const std::optional<Array<double>>& object_to_world) {
    check_shape("shading points", "position", position, {-1, 3});
    const auto count = static_cast<size_t>(position.shape(0));
    check_rows("normal", normal, count, 3);
    check_rows("outgoing", outgoing, count, 3);
    check_rows("uv", uv, count, 2);
    for (const auto& [name, array] :
         {std::pair{"facet_normal", &facet_normal}, std::pair{"dp_du", &dp_du}, std::pair{"dp_dv", &dp_dv},
          std::pair{"dp_dx", &dp_dx}, std::pair{"dp_dy", &dp_dy}})
        check_rows(name, *array, count, 3);
    auto result = std::make_unique<ShadingPoints>();
    result->textures = std::move(textures);
    if (object_to_world) {
        result->instance.object_to_world = affine_of("shading points", *object_to_world);
        result->instance.world_to_object = result->instance.object_to_world.inverse();
    }
    result->points.resize(count);
    result->inputs.resize(count);
    const auto optional = [](const OptionalFloats& array, size_t i, const Vec3f& otherwise) {
        return array ? row_of(*array, i) : otherwise;
    };
    for (size_t i = 0; i < count; ++i) {
        SurfacePoint& point = result->points[i];
        point.position = point.facet_position = Vec3d(row_of(position, i));
        point.normal = row_of(normal, i);
        point.facet_normal = optional(facet_normal, i, point.normal);
        point.uv = uv ? pair(*uv, i) : Vec2f(0.0f, 0.0f);
        point.dp_du = optional(dp_du, i, Vec3f(0.0f));
        point.dp_dv = optional(dp_dv, i, Vec3f(0.0f));
        point.dn_du = point.dn_dv = Vec3f(0.0f);
        ShadingInputs& inputs = result->inputs[i];
        inputs.point = &point;
        inputs.instance = &result->instance;
        inputs.textures = result->textures.get();
        inputs.outgoing = row_of(outgoing, i);
        inputs.differential = {optional(dp_dx, i, Vec3f(0.0f)), optional(dp_dy, i, Vec3f(0.0f)), Vec3f(0.0f),
                               Vec3f(0.0f)};
    }
    return result;
}

std::unique_ptr<ShadingPoints> world_directions(const Floats& direction, const OptionalFloats& dd_dx,
                                                const OptionalFloats& dd_dy, std::shared_ptr<TextureStore> textures) {
    check_shape("world directions", "direction", direction, {-1, 3});
    const auto count = static_cast<size_t>(direction.shape(0));
    check_rows("dd_dx", dd_dx, count, 3);
    check_rows("dd_dy", dd_dy, count, 3);
    auto result = std::make_unique<ShadingPoints>();
    result->textures = std::move(textures);
    result->inputs.resize(count);
    for (size_t i = 0; i < count; ++i) {
        ShadingInputs& inputs = result->inputs[i];
        inputs.textures = result->textures.get();
        inputs.outgoing = -row_of(direction, i);
        inputs.differential = {Vec3f(0.0f), Vec3f(0.0f), dd_dx ? row_of(*dd_dx, i) : Vec3f(0.0f),
                               dd_dy ? row_of(*dd_dy, i) : Vec3f(0.0f)};
    }
    return result;
}

Floats program_values(const ShadingPoints& points, const Program& program, Register target, size_t together) {
    if (together < 1 || together > kMostPoints)
        throw InputError(program.name(), "together", std::to_string(together), "1 to " + std::to_string(kMostPoints));
    if (target < 0 || target >= program.register_count())
        throw InputError(program.name(), "register", std::to_string(target),
                         "0 to " + std::to_string(program.register_count() - 1));
    Floats values = rows(points.inputs.size(), 4);
    std::vector<const ShadingInputs*> inputs;
    for (const ShadingInputs& each : points.inputs) inputs.push_back(&each);
    std::vector<Vec4f> results(inputs.size());
    for (size_t i = 0; i < inputs.size(); i += together)
        program.values(target, {&inputs[i], std::min(together, inputs.size() - i)}, &results[i]);
    for (size_t i = 0; i < inputs.size(); ++i) put(values, i, results[i]);
    return values;
}

py::dict program_results(const ShadingPoints& points, const Program& program) {
    const size_t count = points.inputs.size();
    Floats emission = rows(count, 3), transparency = rows(count, 3);
    Floats holdout(static_cast<py::ssize_t>(count));
    Array<int32_t> lobes(static_cast<py::ssize_t>(count));
    Closures closures;
    for (size_t i = 0; i < count; ++i) {
        program.evaluate(points.inputs[i], closures);
        put(emission, i, closures.emission);
        put(transparency, i, closures.transparency);
        holdout.mutable_data()[i] = closures.holdout;
        lobes.mutable_data()[i] = closures.size();
    }
    py::dict result;
    result["emission"] = emission;
    result["transparency"] = transparency;
    result["holdout"] = holdout;
    result["lobes"] = lobes;
    return result;
}

Closures closures_at(const ShadingPoints& points, const Program& program, size_t index) {
    if (index >= points.inputs.size())
        throw InputError(program.name(), "index", std::to_string(index), "less than the number of points");
    Closures closures;
    program.evaluate(points.inputs[index], closures);
    return closures;
}

Floats evaluate(const Closures& closures, const Vector& outgoing, const Floats& incoming, const Vector& facet_normal,
                std::optional<LobeKind> kind) {
    check_shape("closures", "incoming", incoming, {-1, 3});
    const auto count = static_cast<size_t>(incoming.shape(0));
    Floats values = rows(count, 3);
    for (size_t i = 0; i < count; ++i) {
        const Vec3f direction = row_of(incoming, i);
        put(values, i,
            kind ? closures.evaluate(vec(outgoing), direction, vec(facet_normal), *kind)
                 : closures.evaluate(vec(outgoing), direction, vec(facet_normal)));
    }
    return values;
}

Floats density(const Closures& closures, const Vector& outgoing, const Floats& incoming, const Vector& facet_normal) {
    check_shape("closures", "incoming", incoming, {-1, 3});
    Floats values(incoming.shape(0));
    for (py::ssize_t i = 0; i < incoming.shape(0); ++i)
        values.mutable_data()[i] =
            closures.density(vec(outgoing), row_of(incoming, static_cast<size_t>(i)), vec(facet_normal));
    return values;
}

Floats evaluate_medium(const Closures& closures, const Vector& outgoing, const Floats& incoming) {
    check_shape("closures", "incoming", incoming, {-1, 3});
    const auto count = static_cast<size_t>(incoming.shape(0));
    Floats values = rows(count, 3);
    for (size_t i = 0; i < count; ++i) put(values, i, closures.medium.evaluate(vec(outgoing), row_of(incoming, i)));
    return values;
}

py::dict sample_medium(const Closures& closures, const Vector& outgoing, const Floats& random) {
    check_shape("closures", "random", random, {-1, 3});
    const auto count = static_cast<size_t>(random.shape(0));
    Floats direction = rows(count, 3), weight = rows(count, 3);
    Floats density_of(static_cast<py::ssize_t>(count));
    for (size_t i = 0; i < count; ++i) {
        const PhaseSample s = closures.medium.sample(vec(outgoing), row_of(random, i)).value_or(PhaseSample{});
        put(direction, i, s.direction);
        put(weight, i, s.weight);
        density_of.mutable_data()[i] = s.density;
    }
    py::dict result;
    result["direction"] = direction;
    result["weight"] = weight;
    result["density"] = density_of;
    return result;
}

py::dict sample_closures(const Closures& closures, const Vector& outgoing, const Vector& facet_normal,
                         const Floats& random) {
    check_shape("closures", "random", random, {-1, 3});
    const auto count = static_cast<size_t>(random.shape(0));
    Floats direction = rows(count, 3), weight = rows(count, 3);
    const auto length = static_cast<py::ssize_t>(count);
    Floats density_of(length), eta(length), roughness(length);
    Array<bool> valid(length), singular(length), transmitted(length);
    Array<int32_t> kind(length);
    for (size_t i = 0; i < count; ++i) {
        const std::optional<LobeSample> found = closures.sample(vec(outgoing), vec(facet_normal), row_of(random, i));
        const LobeSample s = found.value_or(LobeSample{Vec3f(0.0f), Color(0.0f)});
        valid.mutable_data()[i] = found.has_value();
        put(direction, i, s.direction);
        put(weight, i, s.weight);
        density_of.mutable_data()[i] = s.density;
        eta.mutable_data()[i] = s.eta;
        roughness.mutable_data()[i] = s.roughness;
        singular.mutable_data()[i] = s.singular;
        transmitted.mutable_data()[i] = s.transmitted;
        kind.mutable_data()[i] = static_cast<int32_t>(s.kind);
    }
    py::dict result;
    result["valid"] = valid;
    result["direction"] = direction;
    result["weight"] = weight;
    result["density"] = density_of;
    result["eta"] = eta;
    result["roughness"] = roughness;
    result["singular"] = singular;
    result["transmitted"] = transmitted;
    result["kind"] = kind;
    return result;
}

constexpr std::pair<const char*, BumpShadow> kBumpShadows[] = {
    {"NONE", BumpShadow::None}, {"CUBIC", BumpShadow::Cubic}, {"FACETS", BumpShadow::Facets}};
constexpr std::pair<const char*, Clearing> kClearings[] = {
    {"NONE", Clearing::None}, {"MIRRORS", Clearing::Mirrors}, {"ALL", Clearing::All}};

void bind_program(py::module_& module) {
    py::class_<Program, std::shared_ptr<Program>>(
        module, "Program", "A flat shader program. The operations are those of core/shading/operations.def.")
        .def(py::init([](const std::string& name, const std::string& bump_shadow, const std::string& clearing) {
                 return std::make_shared<Program>(name, named(name, "bump_shadow", bump_shadow, kBumpShadows),
                                                  named(name, "clearing", clearing, kClearings));
             }),
             py::arg("name"), py::arg("bump_shadow") = "CUBIC", py::arg("clearing") = "ALL")
        .def(
            "constant",
            [](Program& program, float x, float y, float z, float w) { return program.constant(Vec4f(x, y, z, w)); },
            py::arg("x"), py::arg("y"), py::arg("z"), py::arg("w"), "A register that holds four finite numbers.")
        .def(
            "operation",
            [](Program& program, const std::string& identifier, const std::vector<Register>& operands,
               const std::vector<int32_t>& ints, const Array<float>& floats, const std::string& text) {
                check_numbers(program.name(), "floats", floats);
                return program.operation(identifier, operands, ints, span_of(floats), text);
            },
            py::arg("identifier"), py::arg("operands") = std::vector<Register>{},
            py::arg("ints") = std::vector<int32_t>{}, py::arg("floats") = Array<float>(0), py::arg("text") = "",
            "Appends an operation; the register of its result, -1 for closures.")
        .def_property_readonly("name", &Program::name)
        .def_property("bump_width", &Program::bump_width, &Program::set_bump_width)
        .def_property_readonly("emits", &Program::emits)
        .def_property_readonly("may_be_transparent", &Program::may_be_transparent)
        .def_property_readonly("is_constant", &Program::is_constant)
        .def_property_readonly("even_emission", [](const Program& program) -> py::object {
            const std::optional<Color> even = program.even_emission();
            return even ? py::object(py::make_tuple(even->x, even->y, even->z)) : py::none();
        });
}

void bind_points(py::module_& module) {
    using namespace py::literals;
    py::class_<ShadingPoints>(module, "Points", "Points to shade, as arrays.")
        .def("values", &program_values, "program"_a, "register"_a, "together"_a = 1,
             "What a register holds at each point: (n, 4); so many points run together, the values are the same.")
        .def("results", &program_results, "program"_a, "Emission, transparency, holdout, number of lobes, by name.")
        .def("closures", &closures_at, "program"_a, "index"_a, "The closures at one point.");
    module.def("surface_points", &surface_points, "position"_a, "normal"_a, "outgoing"_a, "uv"_a = py::none(),
               "facet_normal"_a = py::none(), "dp_du"_a = py::none(), "dp_dv"_a = py::none(), "dp_dx"_a = py::none(),
               "dp_dy"_a = py::none(), "textures"_a = nullptr, "object_to_world"_a = py::none(),
               "Points of a surface; without a facet normal it is the normal.");
    module.def("world_directions", &world_directions, "direction"_a, "dd_dx"_a = py::none(), "dd_dy"_a = py::none(),
               "textures"_a = nullptr, "Directions into the world.");
}

void bind_closures(py::module_& module) {
    using namespace py::literals;
    py::enum_<LobeKind>(module, "LobeKind", "Pass families.")
        .value("DIFFUSE", LobeKind::Diffuse)
        .value("GLOSSY", LobeKind::Glossy)
        .value("TRANSMISSION", LobeKind::Transmission);
    py::class_<Closures>(module, "Closures", "The closures of one point.")
        .def("__len__", &Closures::size)
        .def("evaluate", &evaluate, "outgoing"_a, "incoming"_a, "facet_normal"_a, "kind"_a = py::none(),
             "Value times cosine for each incoming direction: (n, 3).")
        .def("density", &density, "outgoing"_a, "incoming"_a, "facet_normal"_a, "Density of `sample`: (n,).")
        .def("sample", &sample_closures, "outgoing"_a, "facet_normal"_a, "random"_a,
             "Sampled directions for random numbers (n, 3): arrays by name.")
        .def("evaluate_medium", &evaluate_medium, "outgoing"_a, "incoming"_a,
             "Scattering times phase function, of a medium's program, for each incoming direction: (n, 3).")
        .def("sample_medium", &sample_medium, "outgoing"_a, "random"_a,
             "Directions that a medium's program samples for random numbers (n, 3): arrays by name; density 0: none.")
        .def("has_smooth_lobes", &Closures::has_smooth_lobes)
        .def(
            "albedo",
            [](const Closures& closures, const Vector& outgoing, LobeKind kind) {
                const Color c = closures.albedo(vec(outgoing), kind);
                return Vector{c.x, c.y, c.z};
            },
            "outgoing"_a, "kind"_a);
}

Floats lookup(const TextureStore& store, TextureId id, const Floats& uv, const Floats& duv_dx, const Floats& duv_dy,
              TextureExtension extension, TextureInterpolation interpolation) {
    check_shape("lookup", "uv", uv, {-1, 2});
    check_shape("lookup", "duv_dx", duv_dx, {uv.shape(0), 2});
    check_shape("lookup", "duv_dy", duv_dy, {uv.shape(0), 2});
    const auto count = static_cast<size_t>(uv.shape(0));
    Floats values = rows(count, 4);
    for (size_t i = 0; i < count; ++i)
        put(values, i, store.lookup(id, pair(uv, i), pair(duv_dx, i), pair(duv_dy, i), extension, {interpolation}));
    return values;
}

void bind_textures(py::module_& module) {
    using namespace py::literals;
    py::enum_<ColorSpace>(module, "ColorSpace", "How an image's numbers are meant.")
        .value("SRGB", ColorSpace::Srgb)
        .value("LINEAR", ColorSpace::Linear)
        .value("NON_COLOR", ColorSpace::NonColor);
    py::enum_<TextureExtension>(module, "Extension", "What lies beyond a texture's border.")
        .value("REPEAT", TextureExtension::Repeat)
        .value("EXTEND", TextureExtension::Extend)
        .value("CLIP", TextureExtension::Clip)
        .value("MIRROR", TextureExtension::Mirror)
        .value("PANORAMA", TextureExtension::Panorama);
    py::enum_<TextureInterpolation>(module, "Interpolation", "How a texture is read between pixels.")
        .value("LINEAR", TextureInterpolation::Linear)
        .value("CLOSEST", TextureInterpolation::Closest)
        .value("CUBIC", TextureInterpolation::Cubic);
    py::class_<TextureStore, std::shared_ptr<TextureStore>>(module, "TextureStore", "The image textures of a scene.")
        .def(py::init<size_t>(), "memory_limit"_a)
        .def(
            "add_file",
            [](TextureStore& store, const std::string& name, const std::string& path, ColorSpace space) {
                return store.add_file(name, path, space);
            },
            "name"_a, "path"_a, "space"_a)
        .def(
            "add_pixels",
            [](TextureStore& store, const std::string& name, const Floats& pixels, ColorSpace space) {
                check_shape(name, "pixels", pixels, {-1, -1, -1});
                return store.add_pixels(name, span_of(pixels), static_cast<int>(pixels.shape(1)),
                                        static_cast<int>(pixels.shape(0)), static_cast<int>(pixels.shape(2)), space);
            },
            "name"_a, "pixels"_a, "space"_a)
        .def("lookup", &lookup, "id"_a, "uv"_a, "duv_dx"_a, "duv_dy"_a, "extension"_a, "interpolation"_a)
        .def("statistics", [](const TextureStore& store) {
            const TextureStore::Statistics s = store.statistics();
            py::dict result;
            result["textures"] = s.textures;
            result["bytes"] = s.bytes;
            result["file_reads"] = s.file_reads;
            return result;
        });
}

}  // namespace

void bind_shading(py::module_& module) {
    bind_program(module);
    py::module_ tests = module.def_submodule("shading", "Programs, closures and textures on arrays, for tests.");
    bind_textures(tests);
    bind_points(tests);
    bind_closures(tests);
}

}  // namespace rayleaf
