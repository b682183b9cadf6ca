// A small scene that uses everything, and what every render must hold.
#pragma once

#include "fuzz_input.h"
#include "geometry/patch_surface.h"
#include "geometry/strands.h"
#include "geometry/triangle_mesh.h"
#include "render/session.h"

#include <memory>

namespace rayleaf::fuzz {

inline std::shared_ptr<const Shape> square() {
    static const std::vector<float> places = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
    static const std::vector<int32_t> corners = {0, 1, 2, 0, 2, 3};
    TriangleMeshArrays arrays;
    arrays.name = "square";
    arrays.vertices = places;
    arrays.triangles = corners;
    return std::make_shared<TriangleMesh>(std::move(arrays));
}

/// A waved bicubic patch over the square.
inline std::shared_ptr<const Shape> patch() {
    NurbsSpline spline;
    NurbsSurface& s = spline.surface;
    s.count_u = s.count_v = 4;
    s.u = s.v = {4, false, true, false};
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) s.points.emplace_back(i - 1.5, j - 1.5, 0.3 * ((i * j) % 3), 1.0);
    return std::make_shared<PatchSurface>("patch", std::vector<NurbsSpline>{spline});
}

inline std::shared_ptr<const Shape> strand() {
    static const std::vector<double> points = {-1, 0, 0.5, 0, 0.2, 1, 1, 0, 0.5};
    static const std::vector<float> radii = {0.05f, 0.1f, 0.02f};
    static const std::vector<int32_t> offsets = {0, 3};
    StrandArrays arrays;
    arrays.name = "strand";
    arrays.points = points;
    arrays.radii = radii;
    arrays.offsets = offsets;
    return std::make_shared<Strands>(std::move(arrays));
}

/// A material of one closure without textures, with these further operands.
inline Material plain(const std::string& closure, std::initializer_list<float> operands, const std::string& text = {}) {
    auto program = std::make_shared<Program>(closure);
    std::vector<Register> read = {program->constant(Vec4f(1, 1, 1, 1)), program->constant(Vec4f(0.8f, 0.7f, 0.6f, 1))};
    for (const float value : operands) read.push_back(program->constant(Vec4f(value, value, value, value)));
    program->operation(closure, read, {}, {}, text);
    return {closure, program, 0, std::nullopt, {}};
}

/// Adds an object at a height, with one material.
inline void add_object(SceneDescription& scene, const std::shared_ptr<const Shape>& shape, const Material& material,
                       double height) {
    InstanceDescription instance;
    instance.name = material.name;
    instance.shape = scene.add_shape(shape);
    instance.object_to_world.translation = {0, 0, height};
    instance.material_list = scene.add_material_list({scene.add_material(material)});
    scene.add_instance(instance);
}

inline std::shared_ptr<SceneDescription> small_scene() {
    auto scene = std::make_shared<SceneDescription>();
    add_object(*scene, square(), plain("diffuse", {}), -1);
    add_object(*scene, patch(), plain("glossy", {0.0f}, "SHARP"), 0);
    add_object(*scene, strand(), plain("glass", {0.1f, 1.5f}, "GGX"), 0.5);
    Material mist = plain("diffuse", {});
    mist.volume = VolumeVisualisation{};
    add_object(*scene, patch(), mist, 1);
    Lamp lamp;
    lamp.name = "lamp";
    lamp.to_world.translation = {1, 1, 3};
    lamp.strength = Color(100);
    lamp.radius = 0.1;
    scene->add_lamp(lamp);
    auto world = std::make_shared<Program>("world");
    const Register one = world->constant(Vec4f(1, 1, 1, 1));
    world->operation("background", std::vector<Register>{one, one, one});
    scene->set_world(world, 16);
    CameraDescription camera;
    camera.to_world.translation = {0, 0, 4};
    camera.window_min = Vec2d(-0.4, -0.4);
    camera.window_max = Vec2d(0.4, 0.4);
    scene->set_camera(camera);
    return scene;
}

/// Renders; every number of every pass must be finite.
inline void check_render(const std::shared_ptr<const SceneDescription>& scene, const Settings& settings) {
    Session session(scene, settings);
    require(session.render());
    for (const Pass pass : session.settings().passes)
        for (const float value : session.film().pixels(pass)) require(std::isfinite(value));
}

}  // namespace rayleaf::fuzz
