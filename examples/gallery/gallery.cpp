// A gallery of NURBS surfaces, rendered from their control points: one grid of 6 x 6 points in a row at orders 2 to 6,
// of metal. Writes gallery.ppm.
#include "geometry/patch_surface.h"
#include "render/session.h"

#include <cmath>
#include <vector>

using namespace rayleaf;

namespace {

constexpr int kPoints = 6;

std::shared_ptr<PatchSurface> sheet(int order) {
    NurbsSpline spline;
    spline.surface.count_u = spline.surface.count_v = kPoints;
    spline.surface.u = spline.surface.v = {order, false, true};  // the surface ends at its outer points
    for (int v = 0; v < kPoints; ++v)
        for (int u = 0; u < kPoints; ++u)
            spline.surface.points.emplace_back(u - 2.5, v - 2.5, (u + v) % 2 == 0 ? 0.9 : -0.9, 1.0);
    return std::make_shared<PatchSurface>("order " + std::to_string(order), std::vector{spline});
}

/// A program of one closure.
std::shared_ptr<Program> closure(const char* name, const char* type, std::initializer_list<Vec4f> operands,
                                 const char* text = "") {
    auto program = std::make_shared<Program>(name);
    std::vector<Register> registers{program->constant({1, 1, 1, 1})};  // its weight
    for (const Vec4f& operand : operands) registers.push_back(program->constant(operand));
    program->operation(type, registers, {}, {}, text);
    return program;
}

}  // namespace

int main() {
    auto scene = std::make_shared<SceneDescription>();
    const int copper =
        scene->add_material({"copper", closure("copper", "glossy", {{0.9f, 0.5f, 0.3f, 1}, Vec4f(0.2f)}, "GGX")});
    const int materials = scene->add_material_list({copper});
    for (int order = 2; order <= 6; ++order) {
        Affine3d place;
        place.translation = {(order - 4) * 6.0, 0, 0};
        scene->add_instance({sheet(order)->name(), scene->add_shape(sheet(order)), place, materials});
    }
    scene->set_world(closure("sky", "background", {{0.5f, 0.6f, 0.8f, 1}, Vec4f(0.5f)}), 0);
    Lamp sun{.name = "sun", .kind = LampKind::Sun, .strength = {3, 3, 3}, .angle = 0.02};
    sun.to_world = {{0.8, 0, -0.6}, {0, 1, 0}, {0.6, 0, 0.8}};  // it shines along its -z axis
    scene->add_lamp(sun);
    CameraDescription camera{.kind = CameraKind::Orthographic, .window_min = {-15.5, -3.5}, .window_max = {15.5, 3.5}};
    camera.to_world = {{1, 0, 0}, {0, 0.8, 0.6}, {0, -0.6, 0.8}, {0, -12, 16}};
    scene->set_camera(camera);

    Session session(scene, {.width = 1240, .height = 280, .samples = 64});
    session.take_scene();
    session.render();
    write_ppm(session.film(), "gallery.ppm");
}
